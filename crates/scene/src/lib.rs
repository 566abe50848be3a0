//! What the command and the studio share: a character from files or built in, its settings, how its
//! head moves and who looks at it. The library `tresses` knows nothing of it.
