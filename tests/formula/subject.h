// SPDX-License-Identifier: MIT
// subject.h - a written formula as a surface: read from its text, or made by hand of the public headers.
//
// By hand: value and gradient by dual numbers of doubles, `enclose` by those of intervals (natural and mean
// value form), `rounding` from the interval of F at a point.  It shares numbers.h with the oracle, and
// nothing with what reads texts: what fails by hand too is no fault of the reader, or one of the oracle.
#ifndef FORMULA_SUBJECT_H
#define FORMULA_SUBJECT_H

#include "oracle.h"

#include <memory>
#include <string>
#include <vector>

namespace formula
{

inline double hand_value(const void *self, sgt_vec3 p, sgt_vec3 *n)
{
    return value_at(*static_cast<const written *>(self), p, n);
}
inline sgt_span hand_span(const void *self, const sgt_ray *ray)
{
    return chord_of(static_cast<const written *>(self)->where, *ray);
}
inline sgt_interval hand_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const double o[3] = {ray->o.x, ray->o.y, ray->o.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z};
    const auto over = [&](range s) {
        dual<range> p[3];
        for (int i = 0; i < 3; i++) p[i] = {range(o[i]) + s * range(d[i]), range(d[i])};
        seen = marks();
        return static_cast<const written *>(self)->at(p[0], p[1], p[2]);
    };
    const dual<range> v = over(t);
    *slope = seen.torn() ? sgt_interval_all() : v.s.i;
    if (seen.nowhere) return sgt_interval_empty();
    if (seen.torn() || !has_zero(v.v) || t.lo == t.hi) return v.v.i;
    const double m = sgt_interval_middle(t);
    const range by_mean = over(range(m)).v + v.s * (range(t) - range(m));
    return sgt_interval_intersection(v.v.i, by_mean.i);
}
inline double hand_rounding(const void *self, sgt_vec3 p)
{
    sgt_interval slope;
    const sgt_ray ray = {p, {1, 0, 0}, 0, 0};
    const sgt_interval all = hand_enclose(self, &ray, {0, 0}, &slope);
    const double v = hand_value(self, p, nullptr);
    return std::max(sgt_sum_above(all.hi, -v), sgt_sum_above(v, -all.lo));
}
inline const sgt_surface_ops *hand_ops()
{
    static const sgt_surface_ops ops = [] {
        sgt_surface_ops o = {};
        o.name = "by hand", o.value = hand_value, o.span = hand_span;
        o.rounding = hand_rounding, o.enclose = hand_enclose;
        return o;
    }();
    return &ops;
}

class subject
{
  public:
    subject(const written &f, bool by_hand) : f_(f)
    {
        if (by_hand) {
            surface_ = {hand_ops(), &f_};
            return;
        }
        const std::size_t n = f.named.size();
        const std::size_t size = sgt_formula_room(f.text.c_str(), n);
        room_.resize(size / sizeof(double) + 1);
        sgt_error e = {};
        tape_ = sgt_formula_read(f.text.c_str(), f.sag() ? SGT_FORMULA_XY : SGT_FORMULA_XYZ, n,
                                 f.named.data(), room_.data(), size, &e);
        if (!tape_) {
            error_ = std::string(e.words) + " (column " + std::to_string(e.column) + ")";
            return;
        }
        const place &w = f.where;
        sag_ = {tape_, w.rim};
        level_ = {
            tape_, w.open ? 0 : w.ball, {-w.box[0], -w.box[1], -w.box[2]}, {w.box[0], w.box[1], w.box[2]}};
        surface_ =
            f.sag() ? sgt_surface{&sgt_formula_sag_ops, &sag_} : sgt_surface{&sgt_formula_ops, &level_};
    }
    subject(const subject &) = delete;
    const sgt_surface &surface() const { return surface_; }
    const std::string &error() const { return error_; } // empty: it has been read

  private:
    const written &f_;
    sgt_surface surface_ = {nullptr, nullptr};
    std::string error_;
    std::vector<double> room_;
    sgt_tape *tape_ = nullptr;
    sgt_formula level_ = {};
    sgt_formula_sag sag_ = {};
};

} // namespace formula
#endif
