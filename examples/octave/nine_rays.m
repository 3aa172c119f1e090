% SPDX-License-Identifier: MIT
% Nine rays on a conic, and through a lens, by sagitta from Octave:
%
%     mkoctfile --mex sagitta_batch.c $(pkg-config --cflags --libs sagitta) && octave-cli nine_rays.m
%
% The numbers are printed so that they are read back to the last bit.
1;  % a script, not a function

i = (0:8)';
o = [(i - 4) / 2, i / 8, -10 * ones(9, 1)];
d = [i / 256, -i / 128, ones(9, 1)];

[status, t, t_err, p] = sagitta_batch(o, d, [1 / 51.68, -0.5, 8]);
printf("conic %d\n", sum(status > 0));
printf("%d %.17g %.17g %.17g %.17g %.17g\n", [double(status), t, t_err, p]');

%        c           k    semi_diameter  z     index behind
lens = [ 1 / 51.68,  0,     8,           0,    1.5168
         1 / -700,  -0.5,   8,           4,    1
         0,          0,    12,           97.5, 0 ];
[fate, end_o, end_d, opl] = sagitta_batch(o, d, lens, 1);
printf("lens %d\n", sum(fate == 1));
printf("%d %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", [double(fate), end_o, end_d, opl]');
