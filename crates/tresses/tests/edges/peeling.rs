//! Depth peeling against strands sorted on the CPU.
