// What a precompiled header is made for needs a unit.
