// quad_formulas.cpp - makes formulas.hpp callable from C: F and its gradient in 113 bits.
#include "formulas.hpp"

typedef catalogue::dual<quad, 3> jet;

struct quad_formula {
    catalogue::formula<jet> of;
};

const quad_formula *quad_formula_of(sgt_surface s)
{
    static std::map<std::pair<const void *, const void *>, quad_formula> known;
    if (!catalogue::row_of<jet>(s)) return nullptr;
    return &known.emplace(std::make_pair(s.ops, s.self), quad_formula{catalogue::formula<jet>(s)})
                .first->second;
}

quad quad_value(const quad_formula *f, quad3 p, quad3 *grad)
{
    const jet value = f->of.smooth(jet::variable(p.x, 0), jet::variable(p.y, 1), jet::variable(p.z, 2));
    *grad = {value.v[0], value.v[1], value.v[2]};
    return value.a;
}
