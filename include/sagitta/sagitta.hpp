// SPDX-License-Identifier: MIT
/* sagitta.hpp - the library from C++17: surfaces from lambdas, arrays as views.
 *
 * It adds nothing to the C headers but the writing: each function here is one call of the
 * function of C that its comment names, whose contract holds.  Nothing is allocated,
 * nothing is thrown, and there is nothing to link.  Structs of C are used as they are.
 *
 * Example:
 *
 *     double radius = 2;
 *     auto s = sagitta::surface([radius](sgt_vec3 p, sgt_vec3 *grad) {
 *         if (grad) *grad = {2 * p.x, 2 * p.y, 2 * p.z};
 *         return p.x * p.x + p.y * p.y + p.z * p.z - radius * radius;
 *     });
 *     sgt_hit hit = sagitta::intersect(s, sagitta::ray({0, 0, -4}, {0, 0, 1}));
 *
 * EXCEPTIONS.  A lambda is called by C code, which an exception must not pass through.
 * One that throws ends the program (std::terminate).  Answer NaN where F is not defined.
 *
 * THREADS.  Lambdas are called as const, in the thread that called the library.  If
 * threads share a surface, what its lambdas capture by reference must not change.
 *
 * BITS.  The library's own answers have the same bits everywhere.  Those of a lambda are
 * its compiler's: -ffp-contract=off keeps them the same, -ffast-math takes NaN away. */
#ifndef SAGITTA_SAGITTA_HPP
#define SAGITTA_SAGITTA_HPP
#if __cplusplus < 201703L && !(defined(_MSVC_LANG) && _MSVC_LANG >= 201703L)
#error "sagitta.hpp is C++17: -std=c++17.  The headers of C are C++11."
#endif
#include <cstddef>
#include <limits>
#include <sagitta/diagnose.h>
#include <sagitta/interval.h>
#include <sagitta/sagitta.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>
#include <type_traits>
#include <utility>

namespace sagitta {

/* ------------------------------------------------------------------------ views */

/* size numbers from data on, which stay the caller's.  One of no numbers, {}, stands for
 * an array that is not given or not wanted.  It is made of an array, or of anything that
 * has data() and size() and is not a temporary: std::vector, std::array, std::span. */
template <class T> class view {
public:
    constexpr view() noexcept = default;
    constexpr view(T *data, std::size_t size) noexcept : data_(data), size_(size) {}
    template <std::size_t N>
    constexpr view(T (&array)[N]) noexcept : data_(array), size_(N)
    {
    }
    template <class U, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
    constexpr view(view<U> from) noexcept : data_(from.data()), size_(from.size())
    {
    }
    template <class Container, class U = std::remove_pointer_t<
                                   decltype(std::declval<Container &>().data())>,
              class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
    constexpr view(Container &from) noexcept : data_(from.data()), size_(from.size())
    {
    }
    constexpr T *data() const noexcept { return data_; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }
    constexpr T &operator[](std::size_t i) const noexcept { return data_[i]; }
    constexpr T *begin() const noexcept { return data_; }
    constexpr T *end() const noexcept { return data_ + size_; }
    constexpr bool fits(std::size_t n) const noexcept { return size_ == 0 || size_ == n; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

/* Three of them: all the x, all the y, all the z. */
template <class T> struct views {
    view<T> x, y, z;
    constexpr bool fits(std::size_t n) const noexcept
    {
        return (x.empty() && y.empty() && z.empty()) ||
               (x.size() == n && y.size() == n && z.size() == n);
    }
};

/* What a function of many rays answers if two views differ in length: nothing has been
 * computed.  No count of rays is as large. */
constexpr std::size_t misfit = std::numeric_limits<std::size_t>::max();

/* sgt_rays.  o and d are needed; tmin and tmax may be {}. */
struct rays {
    views<const double> o, d;
    view<const double> tmin, tmax;

    std::size_t size() const noexcept { return o.x.size(); }
    bool fit() const noexcept
    {
        return o.fits(size()) && d.x.size() == size() && d.fits(size()) &&
               tmin.fits(size()) && tmax.fits(size());
    }
    operator sgt_rays() const noexcept
    {
        return {{o.x.data(), o.y.data(), o.z.data()},
                {d.x.data(), d.y.data(), d.z.data()},
                tmin.data(),
                tmax.data()};
    }
};

/* sgt_starts.  p and d are needed; n, p_err and tmax may be {}. */
struct starts {
    views<const double> p, n;
    view<const double> p_err;
    views<const double> d;
    view<const double> tmax;

    std::size_t size() const noexcept { return p.x.size(); }
    bool fit() const noexcept
    {
        return p.fits(size()) && n.fits(size()) && p_err.fits(size()) &&
               d.x.size() == size() && d.fits(size()) && tmax.fits(size());
    }
    operator sgt_starts() const noexcept
    {
        return {{p.x.data(), p.y.data(), p.z.data()},
                {n.x.data(), n.y.data(), n.z.data()},
                p_err.data(),
                {d.x.data(), d.y.data(), d.z.data()},
                tmax.data(),
                {}};
    }
};

/* sgt_hits: set the members that are wanted. */
struct hits {
    view<sgt_status> status;
    view<int> evals;
    view<double> t, t_err, t_lo;
    views<double> p, n;
    view<double> p_err;

    bool fit(std::size_t of) const noexcept
    {
        return status.fits(of) && evals.fits(of) && t.fits(of) && t_err.fits(of) &&
               t_lo.fits(of) && p.fits(of) && n.fits(of) && p_err.fits(of);
    }
    operator sgt_hits() const noexcept
    {
        return {status.data(),
                evals.data(),
                t.data(),
                t_err.data(),
                t_lo.data(),
                {p.x.data(), p.y.data(), p.z.data()},
                {n.x.data(), n.y.data(), n.z.data()},
                p_err.data(),
                {}};
    }
};

/* sgt_traced: the same. */
struct traced {
    view<sgt_fate> fate;
    view<int> passed;
    views<double> o, d;
    view<double> opl;

    bool fit(std::size_t of) const noexcept
    {
        return fate.fits(of) && passed.fits(of) && o.fits(of) && d.fits(of) &&
               opl.fits(of);
    }
    operator sgt_traced() const noexcept
    {
        return {fate.data(),
                passed.data(),
                {o.x.data(), o.y.data(), o.z.data()},
                {d.x.data(), d.y.data(), d.z.data()},
                opl.data(),
                {}};
    }
};

/* --------------------------------------------------------------------- surfaces */

namespace detail {

/* The members of sgt_surface_ops, except its size and its name. */
enum class of {
    value, gradient, span, rounding, clearance, estimate, enclose, values, spans, first,
    firsts, second, parameters, by_parameter, encloses, box
};

/* One lambda, and what it is for. */
template <of Which, class F> struct operation {
    static constexpr of which = Which;
    F function_;
};

template <of Which, class F> const F &chosen(const operation<Which, F> &o) noexcept
{
    return o.function_;
}

/* Pointers that are never NULL are shown to lambdas as references. */
inline const sgt_ray &shown(const sgt_ray *ray) noexcept { return *ray; }
inline sgt_interval &shown(sgt_interval *x) noexcept { return *x; }
template <class T> T shown(T x) noexcept { return x; }

}  // namespace detail

/* A surface from lambdas: the first is F, the others are added by the functions below.
 * Each returns a new surface, so they can be written one after the other:
 *
 *     auto torus = sagitta::surface(f).gradient(g).enclose(e).name("torus");
 *
 * It becomes an sgt_surface by itself wherever one is expected.  That borrows it: it has
 * to stay in place, as the parameters of any surface do.  So a temporary one does not.
 *
 * The table of operations is in the object, and the lambdas are: nothing is allocated. */
template <class... Operations> class surface : private Operations... {
    using of = detail::of;

public:
    /* `value`: double f(sgt_vec3 p), with `gradient` as a lambda of its own or without
     * one; or double f(sgt_vec3 p, sgt_vec3 *grad) for both, grad NULL if not wanted.
     * Without a gradient the solver bisects: some 60 evaluations in place of some 6, and
     * the n of a hit is NaN. */
    template <class F, class = std::enable_if_t<std::is_same_v<
                           surface, sagitta::surface<detail::operation<of::value, F>>>>>
    explicit surface(F f) noexcept : surface("", {std::move(f)})
    {
    }

    /* sgt_vec3 f(sgt_vec3 p), not normalised. */
    template <class F> auto gradient(F f) const { return with<of::gradient>(f); }

    /* The operations of sgt_surface_ops by their names there, with its contracts.  `self`
     * is not shown to them, and rays and slopes come as references:
     *
     *     sgt_span     span(const sgt_ray &ray)
     *     double       rounding(sgt_vec3 p), clearance(sgt_vec3 p), estimate(sgt_vec3 p)
     *     sgt_interval enclose(const sgt_ray &ray, sgt_interval t, sgt_interval &slope)
     *     void         values(std::size_t n, sgt_points p, sgt_values out)
     *     void         spans(std::size_t n, sgt_rays rays, sgt_spans out)
     *     sgt_span     first(const sgt_ray &ray)
     *     void         firsts(std::size_t n, sgt_rays rays, sgt_spans out)
     *     void         second(std::size_t n, sgt_points p, double *const out[6])
     *     std::size_t  parameters()
     *     void         by_parameter(std::size_t j, std::size_t n, sgt_points p,
     *                               sgt_values out)
     *     void         encloses(std::size_t n, sgt_rays rays, const double *t_lo,
     *                           const double *t_hi, sgt_enclosures out)
     *     bool         box(const sgt_interval at[3], sgt_interval *f, sgt_interval g[3],
     *                      sgt_interval second[6]) */
    template <class F> auto span(F f) const { return with<of::span>(f); }
    template <class F> auto rounding(F f) const { return with<of::rounding>(f); }
    template <class F> auto clearance(F f) const { return with<of::clearance>(f); }
    template <class F> auto estimate(F f) const { return with<of::estimate>(f); }
    template <class F> auto enclose(F f) const { return with<of::enclose>(f); }
    template <class F> auto values(F f) const { return with<of::values>(f); }
    template <class F> auto spans(F f) const { return with<of::spans>(f); }
    template <class F> auto first(F f) const { return with<of::first>(f); }
    template <class F> auto firsts(F f) const { return with<of::firsts>(f); }
    template <class F> auto second(F f) const { return with<of::second>(f); }
    template <class F> auto parameters(F f) const { return with<of::parameters>(f); }
    template <class F> auto by_parameter(F f) const { return with<of::by_parameter>(f); }
    template <class F> auto encloses(F f) const { return with<of::encloses>(f); }
    template <class F> auto box(F f) const { return with<of::box>(f); }

    /* For messages; the text is borrowed. */
    surface name(const char *text) const
    {
        return surface(text, static_cast<const Operations &>(*this)...);
    }

    operator sgt_surface() const & noexcept { return {&table_, this}; }
    operator sgt_surface() const && = delete;

private:
    template <class...> friend class surface;

    template <of Which> static constexpr std::size_t count()
    {
        return (std::size_t{0} + ... + std::size_t{Operations::which == Which});
    }

    surface(const char *name, Operations... operations) noexcept
        : Operations(std::move(operations))...
    {
        table_.size = sizeof table_;
        table_.name = *name ? name : nullptr;
        table_.value = value;
        offer<of::span>(table_.span);
        offer<of::rounding>(table_.rounding);
        offer<of::clearance>(table_.clearance);
        offer<of::estimate>(table_.estimate);
        offer<of::enclose>(table_.enclose);
        offer<of::values>(table_.values);
        offer<of::spans>(table_.spans);
        offer<of::first>(table_.first);
        offer<of::firsts>(table_.firsts);
        offer<of::second>(table_.second);
        offer<of::parameters>(table_.parameters);
        offer<of::by_parameter>(table_.by_parameter);
        offer<of::encloses>(table_.encloses);
        offer<of::box>(table_.box);
    }

    template <of Which, class F> auto with(F f) const
    {
        using added = detail::operation<Which, F>;
        static_assert(count<Which>() == 0, "this operation is given twice");
        return surface<Operations..., added>(table_.name ? table_.name : "",
                                             static_cast<const Operations &>(*this)...,
                                             added{std::move(f)});
    }

    /* The function of C that calls the lambda, if there is one. */
    template <of Which, class R, class... A>
    void offer(R (*&member)(const void *, A...)) noexcept
    {
        if constexpr (count<Which>() == 1) {
            using F = decltype(detail::chosen<Which>(std::declval<const surface &>()));
            constexpr bool fits = std::is_invocable_r_v<
                R, F, decltype(detail::shown(std::declval<A>()))...>;
            static_assert(fits, "a lambda has other arguments or another result than the "
                                "list in sagitta.hpp says, or it is mutable");
            if constexpr (fits)
                member = [](const void *self, A... a) noexcept -> R {
                    return detail::chosen<Which>(*static_cast<const surface *>(self))(
                        detail::shown(a)...);
                };
        }
    }

    static double value(const void *self, sgt_vec3 p, sgt_vec3 *grad) noexcept
    {
        const surface &s = *static_cast<const surface *>(self);
        const auto &f = detail::chosen<of::value>(s);
        if constexpr (std::is_invocable_r_v<double, decltype(f), sgt_vec3, sgt_vec3 *>) {
            static_assert(count<of::gradient>() == 0, "value gives the gradient already");
            return f(p, grad);
        } else {
            constexpr double nan = std::numeric_limits<double>::quiet_NaN();
            constexpr bool fits = std::is_invocable_r_v<double, decltype(f), sgt_vec3>;
            static_assert(fits, "F has to be double f(sgt_vec3 p), or "
                                "double f(sgt_vec3 p, sgt_vec3 *grad)");
            if constexpr (count<of::gradient>() == 1) {
                using G = decltype(detail::chosen<of::gradient>(s));
                static_assert(std::is_invocable_r_v<sgt_vec3, G, sgt_vec3>,
                              "the gradient has to be sgt_vec3 f(sgt_vec3 p)");
                if (grad) *grad = detail::chosen<of::gradient>(s)(p);
            } else {
                if (grad) *grad = {nan, nan, nan};
            }
            if constexpr (fits) return f(p);
            return nan;
        }
    }

    sgt_surface_ops table_ = sgt_surface_ops();
};

template <class F> surface(F) -> surface<detail::operation<detail::of::value, F>>;

/* ---------------------------------------------------------------------- answers */

/* The half-line that begins at o.  With ends: sgt_ray_between, whatever they are. */
inline sgt_ray ray(sgt_vec3 o, sgt_vec3 d) noexcept { return {o, d, 0, 0}; }
inline sgt_ray ray(sgt_vec3 o, sgt_vec3 d, double tmin,
                   double tmax = std::numeric_limits<double>::infinity()) noexcept
{
    return sgt_ray_between(o, d, tmin, tmax);
}

/* Sets options.watch to the lambda, which stays the caller's: bool see(const sgt_step &)
 * is shown each evaluation, and answers true to stop. */
template <class F> void watch(sgt_options &options, F &see) noexcept
{
    options.watch = [](void *data, const sgt_step *step) noexcept -> int {
        return (*static_cast<F *>(data))(*step) ? 1 : 0;
    };
    options.watch_data = &see;
}
template <class F> void watch(sgt_options &options, const F &see) = delete;

/* sgt_intersect. */
inline sgt_hit intersect(const sgt_surface &s, const sgt_ray &along,
                         const sgt_options &options = sgt_options()) noexcept
{
    return sgt_intersect(s, along, &options);
}

/* sgt_intersect_batch: how many rays are met; or misfit. */
inline std::size_t intersect(const sgt_surface &s, const rays &along, const hits &out,
                             const sgt_options &options = sgt_options()) noexcept
{
    if (!along.fit() || !out.fit(along.size())) return misfit;
    return sgt_intersect_batch(s, along.size(), along, out, &options);
}

/* sgt_leave. */
inline sgt_crossing leave(const sgt_surface &s, const sgt_start &from,
                          const sgt_options &options = sgt_options()) noexcept
{
    return sgt_leave(s, &from, &options);
}

/* sgt_leave_batch: how many rays are met; or misfit.  side: {}, or one for each ray. */
inline std::size_t leave(const sgt_surface &s, const starts &from, const hits &out,
                         view<signed char> side = {},
                         const sgt_options &options = sgt_options()) noexcept
{
    if (!from.fit() || !out.fit(from.size()) || !side.fits(from.size())) return misfit;
    return sgt_leave_batch(s, from.size(), from, out, side.data(), &options);
}

/* sgt_intersect_all, with room for as many hits as the view has. */
inline int intersect_all(const sgt_surface &s, const sgt_ray &along, view<sgt_hit> room,
                         const sgt_options &options = sgt_options()) noexcept
{
    constexpr std::size_t most = std::numeric_limits<int>::max();
    int cap = static_cast<int>(room.size() < most ? room.size() : most);
    return sgt_intersect_all(s, along, cap, room.data(), &options);
}

/* sgt_trace.  passages: {}, or one for each element; else misfit. */
inline std::size_t trace(view<const sgt_element> lens, double index_before,
                         sgt_ray &launch, sgt_fate &fate, view<sgt_passage> passages = {},
                         const sgt_options &options = sgt_options()) noexcept
{
    if (!passages.fits(lens.size())) return misfit;
    return sgt_trace(lens.size(), lens.data(), index_before, &launch, passages.data(),
                     &fate, &options);
}

/* sgt_trace_batch: how many rays passed; or misfit.  What is in passages is the arrays of
 * C, whose lengths nobody knows. */
inline std::size_t trace(view<const sgt_element> lens, double index_before,
                         const rays &launch, const traced &out,
                         view<const sgt_passages> passages = {},
                         const sgt_options &options = sgt_options()) noexcept
{
    if (!launch.fit() || !out.fit(launch.size()) || !passages.fits(lens.size()))
        return misfit;
    return sgt_trace_batch(lens.size(), lens.data(), index_before, launch.size(), launch,
                           out, passages.data(), &options);
}

/* sgt_check: does the surface keep its promises along these rays? */
inline sgt_fault check(const sgt_surface &s, view<const sgt_ray> along,
                       sgt_vec3 *where = nullptr) noexcept
{
    return sgt_check(s, along.size(), along.data(), where);
}

/* -------------------------------------------------------------------- intervals */

/* sgt_interval with the operators of arithmetic and functions by the names of <cmath>,
 * rounded outward: for `enclose`.  A double is the interval of itself alone.  pow by an
 * int is of all numbers; by anything else it is of those above 0. */
struct interval : sgt_interval {
    interval(double x) noexcept : sgt_interval(sgt_interval_of(x)) {}
    interval(sgt_interval x) noexcept : sgt_interval(x) {}
    interval(double lo_end, double hi_end) noexcept : sgt_interval{lo_end, hi_end} {}

    friend interval operator-(interval x) noexcept { return sgt_interval_negative(x); }
    friend interval operator+(interval x, interval y) noexcept
    {
        return sgt_interval_sum(x, y);
    }
    friend interval operator-(interval x, interval y) noexcept
    {
        return sgt_interval_difference(x, y);
    }
    friend interval operator*(interval x, interval y) noexcept
    {
        return sgt_interval_product(x, y);
    }
    friend interval operator/(interval x, interval y) noexcept
    {
        return sgt_interval_quotient(x, y);
    }
    friend interval square(interval x) noexcept { return sgt_interval_square(x); }
    friend interval sqrt(interval x) noexcept { return sgt_interval_square_root(x); }
    friend interval abs(interval x) noexcept { return sgt_interval_absolute(x); }
    friend interval exp(interval x) noexcept { return sgt_interval_exponential(x); }
    friend interval log(interval x) noexcept { return sgt_interval_logarithm(x); }
    friend interval sin(interval x) noexcept { return sgt_interval_sine(x); }
    friend interval cos(interval x) noexcept { return sgt_interval_cosine(x); }
    friend interval tan(interval x) noexcept { return sgt_interval_tangent(x); }
    friend interval asin(interval x) noexcept { return sgt_interval_arc_sine(x); }
    friend interval acos(interval x) noexcept { return sgt_interval_arc_cosine(x); }
    friend interval atan(interval x) noexcept { return sgt_interval_arc_tangent(x); }
    friend interval sinh(interval x) noexcept { return sgt_interval_hyperbolic_sine(x); }
    friend interval cosh(interval x) noexcept
    {
        return sgt_interval_hyperbolic_cosine(x);
    }
    friend interval tanh(interval x) noexcept
    {
        return sgt_interval_hyperbolic_tangent(x);
    }
    friend interval cbrt(interval x) noexcept { return sgt_interval_cube_root(x); }
    friend interval pow(interval x, int n) noexcept { return sgt_interval_power(x, n); }
    friend interval pow(interval x, double y) noexcept
    {
        return sgt_interval_real_power(x, sgt_interval_of(y));
    }
    friend interval pow(interval x, interval y) noexcept
    {
        return sgt_interval_real_power(x, y);
    }
    friend interval atan2(interval y, interval x) noexcept
    {
        return sgt_interval_angle(y, x);
    }
    friend interval hypot(interval x, interval y) noexcept
    {
        return sgt_interval_hypotenuse(x, y);
    }
    friend interval min(interval x, interval y) noexcept
    {
        return sgt_interval_minimum(x, y);
    }
    friend interval max(interval x, interval y) noexcept
    {
        return sgt_interval_maximum(x, y);
    }
};

}  // namespace sagitta
#endif
