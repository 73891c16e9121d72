"""Flights beside tracks that were measured."""
