/* A link to a folded section opens it. */
(function () {
  "use strict";

  function open() {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    const folded = target && target.querySelector(":scope > details.lf-fold");
    if (folded) folded.open = true;
  }

  window.addEventListener("hashchange", open);
  open();
})();
