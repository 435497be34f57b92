"""Bundled models, each read once: what is collected and what is tested look at the same ones."""

from functools import cache

import contin

load = cache(contin.load)
