// julia.pov - what is timed (DEPTH=0), or the same painted with its distance from the camera (DEPTH=1), which
// tells which root was hit.  CC=1|2: which c; CC=0: a sphere instead, to see that the rays are the same.
// MI: max_iteration; PR: precision, by POV-Ray's own default 20.
//     povray +Ijulia.pov +W640 +H480 +WT1 -D -A -J +FN8 Declare=CC=1 Declare=MI=8 Declare=PR=20 Declare=DEPTH=0
// The distance t < 16: 2^12 t as a whole number in red (in units of 2^-16, half a unit added), its fraction in
// green; blue is 1.  To be written as it is, in 16 bits: File_Gamma=1 +FP16.  An average of three pigments of
// weight one is their sum divided by three.
#include "camera.inc"
#declare LX = CL.x; #declare LY = CL.y; #declare LZ = CL.z;
#declare Units = function(x, y, z) { 4096*sqrt((x - LX)*(x - LX) + (y - LY)*(y - LY) + (z - LZ)*(z - LZ)) }
#declare Red   = function(x, y, z) { (floor(Units(x, y, z)) + 0.5)/65536 }
#declare Green = function(x, y, z) { Units(x, y, z) - floor(Units(x, y, z)) }
#if (DEPTH)
  #declare Paint = pigment { average pigment_map {
    [1 function { Red(x, y, z) }   color_map { [0 rgb 0] [1 rgb <3, 0, 0>] }]
    [1 function { Green(x, y, z) } color_map { [0 rgb 0] [1 rgb <0, 3, 0>] }]
    [1 rgb <0, 0, 3>] } }
#else
  #declare Paint = pigment { rgb 1 }
#end
#switch (CC)
#case (1) #declare C4 = <-0.083, 0.0, -0.83, -0.025>; #break
#case (2) #declare C4 = <-0.2, 0.8, 0, 0>; #break
#end
#if (CC)
  julia_fractal { C4 quaternion sqr max_iteration MI precision PR pigment { Paint } finish { ambient 1 diffuse 0 } }
#else
  sphere { 0, 1.2 pigment { Paint } finish { ambient 1 diffuse 0 } }
#end
