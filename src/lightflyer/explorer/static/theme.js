// Runs before anything is drawn, so that the page does not flash.
"use strict";
{
  let chosen = null;
  try { chosen = localStorage.getItem("lightflyer-theme"); } catch { /* storage may be off */ }
  const dark = chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  document.documentElement.dataset.theme = dark ? "dark" : "light";
}
