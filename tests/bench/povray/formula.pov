// formula.pov - one of four implicit surfaces in a ball of 1.6, as POV-Ray's isosurface: what is timed
// (DEPTH=0), or the same painted with its distance from the camera (DEPTH=1), as julia.pov has it.
// WHICH=1 ... 4: which; GRADIENT: max_gradient, the steepest slope that POV-Ray is told to reckon with.
//     povray +Iformula.pov +W640 +H480 +WT1 -D -A -J +FN8 Declare=WHICH=1 Declare=GRADIENT=100 Declare=DEPTH=0
// `open`: the ball is not seen, only what is inside.
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
#switch (WHICH)
#case (1) // Barth's sextic
  #declare F = function { 4*(2.618033988749895*x*x - y*y)*(2.618033988749895*y*y - z*z)*(2.618033988749895*z*z - x*x)
                          - 4.23606797749979*(x*x + y*y + z*z - 1)*(x*x + y*y + z*z - 1) }
  #break
#case (2) // Clebsch's cubic
  #declare F = function { 81*(x*x*x + y*y*y + z*z*z) - 189*(x*x*(y + z) + y*y*(x + z) + z*z*(x + y)) + 54*x*y*z
                          + 126*(x*y + x*z + y*z) - 9*(x*x + y*y + z*z) - 9*(x + y + z) + 1 }
  #break
#case (3) // Chmutov's of degree 8
  #declare F = function { 2*pow(2*pow(2*x*x - 1, 2) - 1, 2) + 2*pow(2*pow(2*y*y - 1, 2) - 1, 2)
                          + 2*pow(2*pow(2*z*z - 1, 2) - 1, 2) - 2 }
  #break
#case (4) // a gyroid
  #declare F = function { sin(6*x)*cos(6*y) + sin(6*y)*cos(6*z) + sin(6*z)*cos(6*x) }
  #break
#end
isosurface {
  function { F(x, y, z) }
  contained_by { sphere { 0, 1.6 } }
  accuracy 1e-6
  max_gradient GRADIENT
  open
  pigment { Paint }
  finish { ambient 1 diffuse 0 }
}
