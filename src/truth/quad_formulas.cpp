// SPDX-License-Identifier: MIT
// quad_formulas.cpp - makes formulas.hpp and text.hpp callable from C: F and its gradient in 113 bits.
#include "text.hpp"

#include <memory>

typedef catalogue::dual<quad, 3> jet;

// One of the two.
struct quad_formula {
    std::unique_ptr<catalogue::formula<jet>> of;
    std::unique_ptr<catalogue::text_formula<jet>> text;
};

static quad_formula &formula_at(sgt_surface s)
{
    static std::map<std::pair<const void *, const void *>, quad_formula> known;
    return known[std::make_pair(s.ops, s.self)];
}

const quad_formula *quad_formula_of(sgt_surface s)
{
    quad_formula &f = formula_at(s);
    if (!f.of && !f.text && catalogue::row_of<jet>(s)) f.of.reset(new catalogue::formula<jet>(s));
    return f.of || f.text ? &f : nullptr;
}

size_t quad_formula_read(sgt_surface s, const char *text, size_t n, const sgt_named parameter[])
{
    quad_formula &f = formula_at(s);
    f.text.reset(new catalogue::text_formula<jet>(s.ops == &sgt_formula_sag_ops, text, n, parameter));
    return f.text->column();
}

quad quad_value(const quad_formula *f, quad3 p, quad3 *grad)
{
    const jet x = jet::variable(p.x, 0), y = jet::variable(p.y, 1), z = jet::variable(p.z, 2),
              value = f->text ? (*f->text)(x, y, z) : f->of->smooth(x, y, z);
    *grad = {value.v[0], value.v[1], value.v[2]};
    return value.a;
}
