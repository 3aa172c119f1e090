// empty.pov - no surface: what the trace phase costs without one.
#include "camera.inc"
