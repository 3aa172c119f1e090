// SPDX-License-Identifier: MIT
// table.h - the data of the tests: csv files, and decimals of more digits than a double has.
#ifndef ORACLE_TABLE_H
#define ORACLE_TABLE_H

#include <sagitta/surfaces.h>
#include <sagitta/system.h>

#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace oracle {

// A decimal as hi + lo, good to about 2^-100.
struct decimal {
    double hi = NAN, lo = 0;
    decimal() = default;
    explicit decimal(const std::string &text)
    {
        hi = 0;
        bool minus = false, point = false;
        int exponent = 0;
        for (std::size_t i = 0; i < text.size(); i++) {
            const char ch = text[i];
            if (ch == '-') minus = true;
            else if (ch == '.') point = true;
            else if (ch == 'e' || ch == 'E') {
                exponent += std::atoi(text.c_str() + i + 1);
                break;
            } else if (std::isdigit(static_cast<unsigned char>(ch))) {
                times_ten(ch - '0');
                exponent -= point;
            }
        }
        for (; exponent > 0; exponent--) times_ten(0);
        for (; exponent < 0; exponent++) by_ten();
        if (minus) hi = -hi, lo = -lo;
    }
    // this - x, rounded once or nearly so
    double minus(double x) const { return (hi - x) + lo; }

private:
    void settle(double h, double l)
    {
        hi = h + l;
        lo = l - (hi - h);
    }
    void times_ten(double digit)
    {
        const double h = hi * 10, e = std::fma(hi, 10.0, -h);
        const double sum = h + digit, part = sum - h, rest = (h - (sum - part)) + (digit - part);
        settle(sum, rest + e + lo * 10);
    }
    void by_ten()
    {
        const double q = hi / 10, rest = std::fma(-q, 10.0, hi) + lo;
        settle(q, rest / 10);
    }
};

// A csv file without quotes, its first row the names.
struct table {
    std::vector<std::string> names;
    std::vector<std::vector<std::string>> rows;
    explicit table(const std::string &path)
    {
        std::ifstream file(path);
        std::string line;
        while (std::getline(file, line)) {
            std::vector<std::string> cells;
            std::stringstream stream(line);
            std::string cell;
            while (std::getline(stream, cell, ',')) cells.push_back(cell);
            if (!line.empty() && line.back() == ',') cells.emplace_back();
            if (names.empty()) names = cells;
            else rows.push_back(cells);
            if (cells.size() != names.size()) {
                std::fprintf(stderr, "%s: a row of %zu cells: %s\n", path.c_str(), cells.size(),
                             line.c_str());
                std::exit(2);
            }
        }
        if (rows.empty()) {
            std::fprintf(stderr, "%s: not there, or empty\n", path.c_str());
            std::exit(2);
        }
    }
    const std::string &cell(std::size_t row, const char *name) const
    {
        for (std::size_t i = 0; i < names.size(); i++)
            if (names[i] == name) return rows[row][i];
        std::fprintf(stderr, "no column %s\n", name);
        std::exit(2);
    }
    bool has(const char *name) const
    {
        for (const std::string &n : names)
            if (n == name) return true;
        return false;
    }
    double number(std::size_t row, const char *name) const
    {
        return std::strtod(cell(row, name).c_str(), nullptr);
    }
    int whole(std::size_t row, const char *name) const { return std::atoi(cell(row, name).c_str()); }
    sgt_vec3 vector(std::size_t row, const char *x, const char *y, const char *z) const
    {
        return {number(row, x), number(row, y), number(row, z)};
    }
};

// R, k and the terms, as every file here names them.  c = 1/R, rounded once.
inline sgt_even_asphere surface_of(const table &t, std::size_t row)
{
    static const char *const terms[8] = {"a2", "a4", "a6", "a8", "a10", "a12", "a14", "a16"};
    sgt_even_asphere s = {1 / t.number(row, "R"), t.number(row, "k"), 0, {}};
    for (int i = 0; i < 8; i++) s.a[i] = t.number(row, terms[i]);
    return s;
}

inline bool has_terms(const sgt_even_asphere &s)
{
    for (double a : s.a)
        if (a != 0) return true;
    return false;
}

// A surface of any type of the catalogue, and what it borrows; it stays where it is.
struct shape {
    sgt_conic conic = {};
    sgt_odd_asphere odd = {};
    sgt_polynomial_xy xy = {};
    sgt_toroidal toroid = {};
    sgt_torus torus = {};
    std::vector<double> numbers;
    sgt_surface surface = {};
    shape(const table &t, std::size_t row)
    {
        const std::string &type = t.cell(row, "type");
        const double c = 1 / t.number(row, "R"), k = t.number(row, "k");
        std::size_t rows = 0;
        std::stringstream lines(t.cell(row, "coefficients"));
        for (std::string line; std::getline(lines, line, ';'); rows++) {
            std::stringstream numbers_of(line);
            for (double x; numbers_of >> x;) numbers.push_back(x);
        }
        if (type == "plane" || type == "conic") {
            conic = {c, k, 0};
            surface = {&sgt_conic_ops, &conic};
        } else if (type == "odd_asphere") {
            odd = {c, k, 0, {}};
            for (std::size_t i = 0; i < numbers.size(); i++) odd.a[i] = numbers[i];
            surface = {&sgt_odd_asphere_ops, &odd};
        } else if (type == "polynomial_xy") {
            xy = {c, k, 0, {numbers.data(), rows, numbers.size() / rows}};
            surface = {&sgt_polynomial_xy_ops, &xy};
        } else if (type == "toroidal") {
            toroid = {c, k, 1 / t.number(row, "R_x"), 0, {}};
            for (std::size_t i = 0; i < numbers.size(); i++) toroid.a[i] = numbers[i];
            surface = {&sgt_toroidal_ops, &toroid};
        } else if (type == "torus") {
            torus = {t.number(row, "major"), t.number(row, "minor")};
            surface = {&sgt_torus_ops, &torus};
        } else {
            std::fprintf(stderr, "no type %s\n", type.c_str());
            std::exit(2);
        }
    }
    shape(const shape &) = delete;
    shape &operator=(const shape &) = delete;
};

inline sgt_ray ray_of(const table &t, std::size_t row)
{
    return {t.vector(row, "ox", "oy", "oz"), t.vector(row, "dx", "dy", "dz"), t.number(row, "tmin"),
            t.number(row, "tmax")};
}

inline std::vector<decimal> roots_of(const table &t, std::size_t row)
{
    std::vector<decimal> roots;
    std::stringstream text(t.cell(row, "roots"));
    for (std::string root; text >> root;) roots.emplace_back(root);
    return roots;
}

struct hard_case {
    std::string id;
    sgt_even_asphere surface;
    sgt_ray ray;
    std::vector<decimal> roots;
};

inline std::vector<hard_case> hard_cases(const std::string &folder)
{
    const table t(folder + "/hard_cases.csv");
    std::vector<hard_case> cases;
    for (std::size_t i = 0; i < t.rows.size(); i++) {
        hard_case c = {t.cell(i, "id"), surface_of(t, i), ray_of(t, i), roots_of(t, i)};
        c.surface.semi_diameter = t.number(i, "semi_diameter");
        cases.push_back(c);
    }
    return cases;
}

inline const char *const lens_names[] = {"ftheta_laikin", "cooke_triplet", "cassegrain_laikin",
                                         "aspheric_singlet"};

// Those whose surfaces are of the catalogue: a column `type`, and other columns with it.
inline const char *const catalogue_lens_names[] = {"odd_asphere_singlet", "polynomial_xy_singlet",
                                                   "toroidal_lens"};

// A lens and what its elements borrow.
struct lens {
    std::vector<sgt_even_asphere> aspheres;
    std::vector<sgt_conic> conics;
    std::deque<shape> shapes;
    std::vector<sgt_element> elements;
    double length = 1; // the largest coordinate of a vertex, at least 1
    explicit lens(const std::string &path)
    {
        const table t(path);
        const std::size_t n = t.rows.size();
        const bool catalogue = t.has("type");
        for (std::size_t i = 0; i < n; i++) {
            if (catalogue) {
                shapes.emplace_back(t, i);
                continue;
            }
            aspheres.push_back(surface_of(t, i));
            conics.push_back(sgt_conic{aspheres[i].c, aspheres[i].k, 0});
        }
        for (std::size_t i = 0; i < n; i++) {
            const sgt_vec3 o = t.vector(i, "ox", "oy", "oz");
            sgt_element e = {};
            e.surface = catalogue                ? shapes[i].surface
                        : has_terms(aspheres[i]) ? sgt_surface{&sgt_even_asphere_ops, &aspheres[i]}
                                                 : sgt_surface{&sgt_conic_ops, &conics[i]};
            e.pose = sgt_pose_tilted(o, t.vector(i, "tx", "ty", "tz"));
            e.index = t.whole(i, "mirror") ? SGT_MIRROR : t.number(i, "index");
            elements.push_back(e);
            for (double v : {o.x, o.y, o.z}) length = std::fmax(length, std::fabs(v));
        }
    }
    lens(const lens &) = delete;
    lens &operator=(const lens &) = delete;
};

} // namespace oracle
#endif
