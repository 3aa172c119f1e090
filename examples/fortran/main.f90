! SPDX-License-Identifier: MIT
! Nine rays on a conic, and through a lens, by sagitta from Fortran:
!
!     gfortran -O2 sagitta.f90 main.f90 $(pkg-config --libs sagitta) -o main && ./main
!
! The numbers are printed so that they are read back to the last bit.
program main
    use sagitta
    implicit none
    integer, parameter :: rays_count = 9
    real(c_double), target :: o(rays_count, 3), d(rays_count, 3), p(rays_count, 3)
    real(c_double), target :: t(rays_count), t_err(rays_count), opl(rays_count)
    integer(c_signed_char), target :: status(rays_count)
    type(sgt_conic), target :: conic, shapes(3)
    type(sgt_element) :: lens(3)
    type(sgt_rays) :: rays
    type(sgt_hits) :: hits
    type(sgt_traced) :: ends
    integer(c_size_t) :: many
    integer :: i

    do i = 1, rays_count
        o(i, :) = [(i - 5) / 2.0_c_double, (i - 1) / 8.0_c_double, -10.0_c_double]
        d(i, :) = [(i - 1) / 256.0_c_double, (1 - i) / 128.0_c_double, 1.0_c_double]
    end do
    rays = sgt_rays(o=columns(o), d=columns(d))

    conic = sgt_conic(c=1 / 51.68_c_double, k=-0.5_c_double, semi_diameter=8)
    hits%status = c_loc(status)
    hits%t = c_loc(t)
    hits%t_err = c_loc(t_err)
    hits%p = columns(p)
    many = sgt_intersect_batch(on(conic), int(rays_count, c_size_t), rays, hits, c_null_ptr)
    print '(a, 1x, i0)', 'conic', many
    do i = 1, rays_count
        print '(i0, 5(1x, es26.17e3))', status(i), t(i), t_err(i), p(i, :)
    end do

    shapes(1) = sgt_conic(c=1 / 51.68_c_double)
    shapes(2) = sgt_conic(c=1 / (-700.0_c_double), k=-0.5_c_double)
    lens(1) = element(shapes(1), 0.0_c_double, 1.5168_c_double, 8.0_c_double)
    lens(2) = element(shapes(2), 4.0_c_double, 1.0_c_double, 8.0_c_double)
    lens(3) = element(shapes(3), 97.5_c_double, 0.0_c_double, 12.0_c_double)
    ! The ends may be written over the rays they came from.
    ends%fate = c_loc(status)
    ends%o = columns(o)
    ends%d = columns(d)
    ends%opl = c_loc(opl)
    many = sgt_trace_batch(size(lens, kind=c_size_t), lens, 1.0_c_double, &
                           int(rays_count, c_size_t), rays, ends, c_null_ptr, c_null_ptr)
    print '(a, 1x, i0)', 'lens', many
    do i = 1, rays_count
        print '(i0, 7(1x, es26.17e3))', status(i), o(i, :), d(i, :), opl(i)
    end do

contains

    ! The addresses of the columns of x, y and z: in Fortran each is contiguous, as C wants it.
    function columns(a) result(of)
        real(c_double), intent(in), target :: a(rays_count, 3)
        type(c_ptr) :: of(3)
        of = [c_loc(a(1, 1)), c_loc(a(1, 2)), c_loc(a(1, 3))]
    end function

    ! A surface borrows its parameters, which have to be targets that stay.
    function on(shape) result(s)
        type(sgt_conic), intent(in), target :: shape
        type(sgt_surface) :: s
        s = sgt_surface(ops=c_loc(sgt_conic_ops), self_=c_loc(shape))
    end function

    function element(shape, z, index, semi_diameter) result(e)
        type(sgt_conic), intent(in), target :: shape
        real(c_double), intent(in) :: z, index, semi_diameter
        type(sgt_element) :: e
        e%surface = on(shape)
        e%pose%origin%z = z
        e%index = index
        e%semi_diameter = semi_diameter
    end function
end program
