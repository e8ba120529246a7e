"""Initialisers: ways to start a track without a previous pose."""
