// SPDX-License-Identifier: MIT
// formulas.h - the formulas of these tests: each as a text, as its user would write it, and once more as C++
// that shares nothing with what reads texts.  Their table is in formulas.cpp.
#ifndef FORMULA_FORMULAS_H
#define FORMULA_FORMULAS_H

#include "numbers.h"

#include <sagitta/formula.h>

#include <memory>
#include <string>
#include <vector>

namespace formula {

struct place {
    double ball, box[3], rim, reach;
    bool open;
    double size() const
    {
        const double b = std::sqrt(box[0] * box[0] + box[1] * box[1] + box[2] * box[2]);
        return rim > 0 ? std::max(rim, reach) : ball > 0 ? ball : b;
    }
};

class written {
public:
    std::string name, text;
    place where;
    bool touches;
    std::vector<sgt_named> named;
    std::vector<sgt_vec3> special;
    virtual ~written() = default;
    bool sag() const { return where.rim > 0; }
    virtual bool is_random() const { return false; }
    // Are all its parts there well within the range of doubles?
    virtual bool is_tame(const sgt_vec3 &) const { return true; }

    // F, and for surfaces that touch, what is squared.
    virtual ball at(const ball &x, const ball &y, const ball &z, bool root = false) const = 0;
    virtual dual<ball> at(const dual<ball> &x, const dual<ball> &y, const dual<ball> &z,
                          bool root = false) const = 0;
    virtual dual<dual<ball>> at(const dual<dual<ball>> &x, const dual<dual<ball>> &y,
                                const dual<dual<ball>> &z) const = 0;
    virtual dual<double> at(const dual<double> &x, const dual<double> &y, const dual<double> &z,
                            bool root = false) const = 0;
    virtual dual<range> at(const dual<range> &x, const dual<range> &y, const dual<range> &z) const = 0;
    // By parameter j: a dual of it; of that the derivatives by the point.
    virtual dual<dual<ball>> by(std::size_t j, const dual<dual<ball>> &x, const dual<dual<ball>> &y,
                                const dual<dual<ball>> &z) const = 0;
};

std::vector<std::unique_ptr<written>> &formulas();

} // namespace formula
#endif
