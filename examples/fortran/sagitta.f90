! SPDX-License-Identifier: MIT
! What main.f90 needs of sagitta.h, surfaces.h and system.h, by the names of C.
!
! A declaration that differs from C is no error to the compiler, and reads other numbers than were meant.  So
! tests/build/languages.py compares this file with the headers: each type by its size and the offsets of its
! members, each function by a call with its arguments.  Copy the check with the file.
module sagitta
    use, intrinsic :: iso_c_binding
    implicit none

    type, bind(C) :: sgt_vec3
        real(c_double) :: x = 0, y = 0, z = 0
    end type

    ! One array for each number.  c_null_ptr for tmin is 0, for tmax infinity.
    type, bind(C) :: sgt_rays
        type(c_ptr) :: o(3), d(3)
        type(c_ptr) :: tmin = c_null_ptr, tmax = c_null_ptr
    end type

    type, bind(C) :: sgt_surface
        type(c_ptr) :: ops = c_null_ptr, self_ = c_null_ptr
    end type

    type, bind(C) :: sgt_conic
        real(c_double) :: c = 0, k = 0, semi_diameter = 0
    end type

    ! An array that is c_null_ptr is not wanted.
    type, bind(C) :: sgt_hits
        type(c_ptr) :: status = c_null_ptr, evals = c_null_ptr, t = c_null_ptr, t_err = c_null_ptr
        type(c_ptr) :: t_lo = c_null_ptr, p(3) = c_null_ptr, n(3) = c_null_ptr, p_err = c_null_ptr
        integer(c_long_long) :: reserved_(2) = 0
    end type

    type, bind(C) :: sgt_pose
        type(sgt_vec3) :: origin, ex, ey, ez
    end type

    type, bind(C) :: sgt_element
        type(sgt_surface) :: surface
        type(sgt_pose)    :: pose
        real(c_double)    :: index = 0, semi_diameter = 0
        type(c_ptr)       :: aperture = c_null_ptr, phase = c_null_ptr
        integer(c_long_long) :: reserved_(6) = 0
    end type

    type, bind(C) :: sgt_traced
        type(c_ptr) :: fate = c_null_ptr, passed = c_null_ptr
        type(c_ptr) :: o(3) = c_null_ptr, d(3) = c_null_ptr, opl = c_null_ptr
        integer(c_long_long) :: reserved_(2) = 0
    end type

    ! The table of operations of the built-in conic: only its address is used, with c_loc.
    integer(c_size_t), bind(C, name='sgt_conic_ops'), target :: sgt_conic_ops

    interface
        ! opt: an sgt_options, or c_null_ptr for all defaults.
        function sgt_intersect_batch(s, n, rays, hits, opt) bind(C) result(met)
            import
            type(sgt_surface), value :: s
            integer(c_size_t), value :: n
            type(sgt_rays), value    :: rays
            type(sgt_hits), value    :: hits
            type(c_ptr), value       :: opt
            integer(c_size_t)        :: met
        end function

        function sgt_trace_batch(elements, e, index_before, n, rays, out, passages, opt) bind(C) result(many)
            import
            integer(c_size_t), value      :: elements
            type(sgt_element), intent(in) :: e(*)
            real(c_double), value         :: index_before
            integer(c_size_t), value      :: n
            type(sgt_rays), value         :: rays
            type(sgt_traced), value       :: out
            type(c_ptr), value            :: passages, opt
            integer(c_size_t)             :: many
        end function
    end interface
end module
