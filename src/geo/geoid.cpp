// SPDX-License-Identifier: MIT
// geoid.cpp - the points at height h over a geoid.  A grid gives the geoid's heights N over WGS84.
//
// F = (geodetic height) - N(latitude, longitude) - h.  Between the nodes N is the bicubic convolution of Keys
// 1981 (IEEE Trans. ASSP 29, 1153; a = -1/2): along each axis the cubic through z1 and z2 with the slopes
// (z2 - z0) / 2 and (z3 - z1) / 2.  Beyond a pole the grid continues on the opposite meridian.
//
// BOUNDS.  Let the first and second differences of the nodes about a cell, along an axis, be at most D and E,
// and the mixed ones at most X.  Then
//     slope <= 1.5 D and second derivative <= 3 E along that axis, each times 1.25, the largest sum of the
//         |weights| along the other axis;
//     mixed derivative <= 2.25 X.
// The bounds are kept for each row of cells, per metre on the ground, and include the convergence of the
// meridians: `tilt` bounds the slope of N, `twist` the Lipschitz constant of that slope.
//
// AT A POLE the surface has a corner.  Let s be the part of the cell between the pole and the point.
// Differences from meridian to meridian are at most 1.8 s of those of the nodes: the |weights| of the other
// rows are below s / 2, 7 s / 6 and s / 8, and a pole has one height, or the grid is refused.  So there
// `corner` / (distance from the pole) is added to twist; corner[0] is south, corner[1] north.
#include "earth.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#ifndef SGT_PROJ_DATA
#define SGT_PROJ_DATA "/usr/share/proj"
#endif

struct sgt_geoid {
    int rows = 0,
        columns = 0; // rows from south to north, both poles among them; columns eastward, all around
    double west = 0;           // longitude of the first column, degrees
    std::vector<float> height;       // [rows][columns], metres
    std::vector<double> tilt, twist; // of the cells between rows i and i + 1
    double steepest = 0, corner[2] = {0, 0}, low = 0, high = 0;

    // The height at node (i, j); i may be a little beyond the poles.
    double node(int i, int j) const
    {
        if (i < 0) i = -i, j += columns / 2;
        if (i > rows - 1) i = 2 * (rows - 1) - i, j += columns / 2;
        j %= columns;
        return static_cast<double>(height[static_cast<size_t>(i) * static_cast<size_t>(columns) +
                                          static_cast<size_t>(j < 0 ? j + columns : j)]);
    }
};

namespace geo {
namespace {

constexpr double DEGREE = 0.017453292519943295;
constexpr double DEEPEST = -6e6;   // of h
constexpr double HOLE = -88.8888;  // the mark of a missing height in .gtx files
constexpr int MOST = 21601;        // rows: a 30" grid

// ------------------------------------------------------------ between the nodes

// The weights w of four nodes, at the part s of the way from the second to the third; d: derivatives by s.
struct weights { double w[4], d[4]; };

weights weights_at(double s)
{
    double r = 1 - s;
    return {{-0.5 * s * r * r, 1 + s * s * (1.5 * s - 2.5), s * (0.5 + s * (2 - 1.5 * s)), -0.5 * s * s * r},
            {-0.5 * r * (1 - 3 * s), s * (4.5 * s - 5), 0.5 + s * (4 - 4.5 * s), -0.5 * s * (2 - 3 * s)}};
}

struct undulation { double N, by_latitude, by_longitude; }; // per radian

undulation undulation_at(const sgt_geoid &g, double latitude, double longitude)
{
    double y = (latitude + 90) * (g.rows - 1) / 180, x = (longitude - g.west) * g.columns / 360;
    x -= g.columns * std::floor(x / g.columns);
    int i = std::clamp(static_cast<int>(y), 0, g.rows - 2),
        j = std::clamp(static_cast<int>(x), 0, g.columns - 1);
    weights u = weights_at(y - i), v = weights_at(x - j);
    undulation n = {0, 0, 0};
    for (int k = 0; k < 4; k++) {
        double z = 0, slope = 0;
        for (int m = 0; m < 4; m++) {
            double node = g.node(i + k - 1, j + m - 1);
            z += v.w[m] * node, slope += v.d[m] * node;
        }
        n.N += u.w[k] * z, n.by_latitude += u.d[k] * z, n.by_longitude += u.w[k] * slope;
    }
    n.by_latitude *= (g.rows - 1) / (180 * DEGREE), n.by_longitude *= g.columns / (360 * DEGREE);
    return n;
}

// tilt and twist of every row of cells.
void bound(sgt_geoid &g)
{
    const double ground = wgs84().least * 0.999, step_y = 180 * DEGREE / (g.rows - 1),
                 step_x = 360 * DEGREE / g.columns;
    size_t rows = static_cast<size_t>(g.rows);
    std::vector<double> north(rows + 3), north2(rows + 3), east(rows + 3), east2(rows + 3),
        mixed(rows + 3); // index i: of node row i - 1, or of the step north of it
    g.low = g.high = g.node(0, 0);
    for (int i = -1; i <= g.rows; i++) {
        size_t at = static_cast<size_t>(i + 1);
        for (int j = 0; j < g.columns; j++) {
            double z = g.node(i, j), right = g.node(i, j + 1);
            g.low = std::min(g.low, z), g.high = std::max(g.high, z);
            east[at] = std::max(east[at], std::fabs(right - z));
            east2[at] = std::max(east2[at], std::fabs(right - 2 * z + g.node(i, j - 1)));
            if (i == g.rows) continue;
            double up = g.node(i + 1, j);
            north[at] = std::max(north[at], std::fabs(up - z));
            if (i > -1) north2[at] = std::max(north2[at], std::fabs(up - 2 * z + g.node(i - 1, j)));
            mixed[at] = std::max(mixed[at], std::fabs(g.node(i + 1, j + 1) - up - right + z));
        }
    }
    for (int i = 0; i + 1 < g.rows; i++) { // node rows i - 1 ... i + 2 are at i ... i + 3
        auto most = [&](const std::vector<double> &of, int from, int to) {
            return *std::max_element(of.begin() + i + from, of.begin() + i + to + 1);
        };
        double pole = std::max(std::fabs(-90 + 180.0 * i / (g.rows - 1)),
                               std::fabs(-90 + 180.0 * (i + 1) / (g.rows - 1))),
               close = std::cos(pole * DEGREE);
        double y1 = 1.875 * most(north, 0, 2) / step_y, x1 = 1.875 * most(east, 0, 3) / step_x,
               y2 = 3.75 * most(north2, 1, 2) / (step_y * step_y);
        double x2 = 3.75 * most(east2, 0, 3) / (step_x * step_x),
               xy = 2.25 * most(mixed, 0, 2) / (step_x * step_y);
        if (close > 1e-9) {
            double tilt = std::hypot(y1, x1 / close) / ground;
            g.tilt.push_back(tilt);
            g.twist.push_back((y2 + x2 / (close * close) + 2 * xy / close) / (ground * ground) +
                              tilt * (4 + 2 / close) / ground);
        } else {
            // At the pole N is the same on all meridians: differences between meridians grow with the
            // distance from the pole.
            double near = std::cos((pole - 180.0 / (g.rows - 1)) * DEGREE);
            double x1_s = 1.5 * 1.8 * most(east, 0, 3) / step_x,
                   x2_s = 3 * 1.8 * most(east2, 0, 3) / (step_x * step_x),
                   tilt = std::hypot(y1, x1_s / near) / ground;
            g.tilt.push_back(tilt);
            g.twist.push_back(y2 / (ground * ground) + 4 * tilt / ground);
            g.corner[i > 0] = 1.1 / ground * ((x2_s + 2 * x1_s) / step_y + 2 * xy + 2 * y1);
        }
    }
    for (double &tilt : g.tilt) g.steepest = std::max(g.steepest, tilt);
}

// --------------------------------------------------------------------- the file

// Of a path that is too long the end is kept.
void say(sgt_error *error, const std::string &path, const std::string &what)
{
    if (!error) return;
    *error = {};
    const size_t most = sizeof error->file - 1;
    std::snprintf(error->file, sizeof error->file, "%s",
                  path.c_str() + (path.size() > most ? path.size() - most : 0));
    std::snprintf(error->words, sizeof error->words, "%s", what.c_str());
}

uint64_t whole(const unsigned char *bytes, int n) // big-endian
{
    uint64_t x = 0;
    for (int i = 0; i < n; i++) x = x << 8 | bytes[i];
    return x;
}

double real(const unsigned char *bytes)
{
    uint64_t bits = whole(bytes, 8);
    double x;
    std::memcpy(&x, &bits, sizeof x);
    return x;
}

float single(const unsigned char *bytes)
{
    uint32_t bits = static_cast<uint32_t>(whole(bytes, 4));
    float x;
    std::memcpy(&x, &bits, sizeof x);
    return x;
}

struct close_file { void operator()(std::FILE *file) const { std::fclose(file); } };

// Reads a grid; returns "" or what is wrong.
std::string read(const char *path, sgt_geoid &g)
{
    enum { HEADER = 40 };
    unsigned char head[HEADER];
    std::unique_ptr<std::FILE, close_file> file(std::fopen(path, "rb"));
    if (!file) return std::string("cannot be opened: ") + std::strerror(errno);
    errno = 0;
    size_t got = std::fread(head, 1, HEADER, file.get());
    if (std::ferror(file.get())) return std::string("cannot be read: ") + std::strerror(errno ? errno : EIO);
    if (got < HEADER) return "cut off in the header: " + std::to_string(got) + " of 40 bytes";
    double south = real(head), west = real(head + 8), step_y = real(head + 16), step_x = real(head + 24);
    uint64_t rows = whole(head + 32, 4), columns = whole(head + 36, 4);
    if (!(rows >= 5 && rows <= MOST && columns >= 8 && columns <= 2 * (MOST - 1)))
        return "not a .gtx grid: " + std::to_string(rows) + " rows of " + std::to_string(columns) +
               " columns (5 to " + std::to_string(MOST) + ", 8 to " + std::to_string(2 * (MOST - 1)) + ")";
    if (!(std::fabs(west) <= 360 && std::fabs(south + 90) < 1e-6 &&
          std::fabs(step_y * static_cast<double>(rows - 1) - 180) < 1e-6 &&
          std::fabs(step_x * static_cast<double>(columns) - 360) < 1e-6 && columns % 2 == 0))
        return "not a grid of the globe, from pole to pole and all around in an even number of columns: it "
               "begins at latitude " +
               std::to_string(south) + " and longitude " + std::to_string(west) + ", in steps of " +
               std::to_string(step_y) + " and " + std::to_string(step_x) + " degrees, " +
               std::to_string(rows) + " rows of " + std::to_string(columns) + " columns";
    g.rows = static_cast<int>(rows), g.columns = static_cast<int>(columns), g.west = west;
    size_t count = static_cast<size_t>(rows * columns);
    std::vector<unsigned char> row(static_cast<size_t>(columns) * 4);
    for (uint64_t i = 0; i < rows; i++) { // memory grows with what the file really has
        got = std::fread(row.data(), 1, row.size(), file.get());
        if (std::ferror(file.get()))
            return std::string("cannot be read: ") + std::strerror(errno ? errno : EIO);
        if (got < row.size())
            return "cut off: " + std::to_string(HEADER + i * row.size() + got) + " bytes, and " +
                   std::to_string(rows) + " rows of " + std::to_string(columns) + " columns need " +
                   std::to_string(HEADER + 4 * count);
        for (size_t j = 0; j < columns; j++) {
            float z = single(&row[4 * j]);
            if (!(std::fabs(z) < 1000) || std::fabs(static_cast<double>(z) - HOLE) < 1e-4)
                return "a hole in the grid: row " + std::to_string(i + 1) + ", column " +
                       std::to_string(j + 1) + " has no height (" + std::to_string(z) + ")";
            g.height.push_back(z);
            if ((i == 0 || i == rows - 1) && z != g.height[g.height.size() - 1 - j]) // N would jump there
                return "the heights of a pole differ: row " + std::to_string(i + 1) + " has " +
                       std::to_string(g.height[g.height.size() - 1 - j]) + " in column 1 and " +
                       std::to_string(z) + " in column " + std::to_string(j + 1);
        }
    }
    if (std::fgetc(file.get()) != EOF)
        return "too long: more than the " + std::to_string(HEADER + 4 * count) + " bytes of " +
               std::to_string(rows) + " rows of " + std::to_string(columns) + " columns";
    bound(g);
    return "";
}

// ------------------------------------------------------------------ the surface

sgt_objection object(const sgt_geoid_height &s)
{
    if (!s.geoid) return {"file", "missing, or not read"};
    if (!(s.h >= DEEPEST && s.h <= 1e100)) return {"h", "must be from -6e6 to 1e100 m"};
    return {nullptr, nullptr};
}

struct above {
    bool valid;
    const sgt_geoid *geoid;
    double h;
    const ellipsoid &e;
    shell body; // set by prepare()
    explicit above(const void *self) : above(*static_cast<const sgt_geoid_height *>(self)) {}
    explicit above(const sgt_geoid_height &s)
        : valid(!object(s).param), geoid(s.geoid), h(s.h), e(wgs84()), body()
    {
    }

    // A shell that reaches above the highest N and below the lowest.  Along each axis a cubic exceeds its
    // nodes by at most 1/8 of their difference, so both together by less than 0.3 of it.
    void prepare()
    {
        double beyond = 0.3 * (geoid->high - geoid->low);
        shell inner = shell_of(e, h + geoid->low - beyond), outer = shell_of(e, h + geoid->high + beyond);
        body = outer;
        body.inner = std::fmin(inner.a / outer.a, inner.b / outer.b) * inner.inner * (1 - 0x1p-40);
    }

    double value(const sgt_vec3 &p, sgt_vec3 *grad) const { return value_over(e.below(p), grad); }
    double value_over(const foot &q, sgt_vec3 *grad) const
    {
        if (!(std::fabs(q.latitude) <= 90 && std::fabs(q.longitude) <= 180)) return no_gradient(grad);
        undulation n = undulation_at(*geoid, q.latitude, q.longitude);
        if (grad) {
            double north = n.by_latitude / (e.meridian(q.sin_latitude) + q.h),
                   circle = (e.vertical(q.sin_latitude) + q.h) * q.cos_latitude,
                   east = circle > 0 ? n.by_longitude / circle : 0;
            if (!(circle > 0)) north = 0; // a pole
            *grad = {q.up.x + north * q.sin_latitude * q.cos_longitude + east * q.sin_longitude,
                     q.up.y + north * q.sin_latitude * q.sin_longitude - east * q.cos_longitude,
                     q.up.z - north * q.cos_latitude};
        }
        return q.h - n.N - h;
    }
    // A bound on the rounding of N, in units of 2^-53: 64 of its nodes, and its slope times 4 of the place on
    // the ground.
    double rounding_of_N(double size) const
    {
        return 0x1p-53 * (64 * std::fmax(std::fabs(geoid->low), std::fabs(geoid->high)) +
                          4 * geoid->steepest * (e.most + size));
    }
    double rounding(double size, double over) const
    {
        return e.rounding(size, over) + rounding_of_N(size) + 0x1p-52 * (std::fabs(over) + std::fabs(h));
    }
    double rounding(const sgt_vec3 &p) const { return rounding(length(p), e.farthest(length(p))); }

    chord across(const sgt_ray &ray) const { return chord_of(body, ray); }
    sgt_span span(const sgt_ray &ray) const { return span_of(across(ray)); }

    // The height is convex along a ray.  So if at the inner ellipsoid the ray falls more steeply than N can
    // rise, it has done so since the outer ellipsoid, and there is one root between them.  The same holds
    // where the ray leaves.
    sgt_span first(const sgt_ray &ray) const
    {
        chord c = across(ray);
        if (!c.known || c.by) return span_of(c);
        double tmax = ray.tmax, along = length(ray.d);
        double margin = 1e-3 / along + 0x1p-46 * std::fabs(c.lo),
               steep = 1.1 * geoid->steepest * along * e.least /
                       (e.least + std::fmin(h + geoid->low, 0) - 100);
        if (ray.tmin > c.hi || tmax < c.lo) return {infinity, -infinity, nothing, false};
        if (!(c.in < c.out)) return span_of(c);
        if (ray.tmin < c.lo - margin && dot(e.below(at(ray, c.in)).up, ray.d) < -steep - 1e-3 * along)
            return {c.lo, c.in, c.entry, true};
        if (ray.tmin >= c.in && ray.tmin <= c.out &&
            dot(e.below(at(ray, c.out)).up, ray.d) > steep + 1e-3 * along)
            return {ray.tmin, c.hi, c.exit, true};
        return span_of(c);
    }

    // The height by convexity (earth.cpp), N by its bounds about the middle.  A point on the ground moves as
    // far as its point of the ray does, times a ratio of radii e / (e + h).
    sgt_interval enclose(const sgt_ray &ray, sgt_interval t, sgt_interval *slope) const
    {
        double middle = 0.5 * t.lo + 0.5 * t.hi, along = length(ray.d),
               half = std::fmax(t.hi - middle, middle - t.lo) * (1 + 0x1p-50) * along;
        foot ends[2] = {e.below(at(ray, t.lo)), e.below(at(ray, t.hi))}, q = e.below(at(ray, middle));
        reading r[2];
        for (int i = 0; i < 2; i++) {
            double size = length(at(ray, i ? t.hi : t.lo));
            r[i] = {ends[i].h, e.rounding(size, ends[i].h) + 0x1p-53 * size, dot(ends[i].up, ray.d),
                    along * (e.direction(size, ends[i].h) + 0x1p-50)};
        }
        sgt_interval all = sgt_interval_all(), high = convex(t, r[0], r[1], slope);
        double low = q.h - half, ratio = e.most / (e.least + low); // of the ground to the ray
        sgt_vec3 grad;
        double g = value_over(q, &grad), size = length(at(ray, middle)),
               N_err = rounding_of_N(size) + 0x1p-51 * (std::fabs(q.h) + std::fabs(h)) +
                       0x1p-52 * geoid->steepest * size;
        if (!(low > -0.9 * e.least && half < infinity) || std::isnan(g)) {
            *slope = all;
            return sgt_interval_sum(high, {-geoid->high - 0.3 * (geoid->high - geoid->low) - h,
                                           -geoid->low + 0.3 * (geoid->high - geoid->low) - h});
        }
        // the rows of cells under the stretch
        double rows = geoid->rows - 1, y = (q.latitude + 90) * rows / 180,
               reach = half * ratio / e.least / DEGREE * rows / 180 * (1 + 1e-9) + 1e-9;
        int from = static_cast<int>(std::clamp(std::floor(y - reach), 0.0, rows - 1)),
            to = static_cast<int>(std::clamp(std::floor(y + reach), 0.0, rows - 1));
        double tilt = geoid->steepest, twist = infinity;
        if (to - from < 64) {
            tilt = twist = 0;
            for (int i = from; i <= to; i++)
                tilt = std::max(tilt, geoid->tilt[static_cast<size_t>(i)]),
                twist = std::max(twist, geoid->twist[static_cast<size_t>(i)]);
            if (from == 0 || to == geoid->rows - 2) {
                sgt_vec3 p = at(ray, middle);
                double away = 0.98 * (std::hypot(p.x, p.y) - half) * e.least /
                              (e.most + q.h + half); // from the pole, on the ground
                twist = away > 0 ? twist + geoid->corner[q.latitude > 0] / away : infinity;
            }
        }
        double N = q.h - g - h, off = tilt * ratio * half, most = tilt * ratio * along;
        // g from the ranges of the height and of N; the slope from those of their slopes.  However flat N is,
        // the error of lean is the rounding of the components of grad and up.
        sgt_vec3 lean = {grad.x - q.up.x, grad.y - q.up.y, grad.z - q.up.z};
        double now = dot(lean, ray.d), turn = twist * ratio * ratio * along * half +
                                              tilt * ratio * 4 / (e.least + low) * along * half +
                                              along * (0x1p-44 * tilt + 0x1p-50);
        sgt_interval with = {now - turn, now + turn},
                     steep = sgt_interval_intersection({-most, most}, turn < infinity ? with : all);
        off = std::fmin(off,
                        turn < infinity ? (std::fabs(now) + turn) / along * half * (1 + 0x1p-40) : infinity);
        *slope = sgt_interval_sum(*slope, steep);
        return sgt_interval_sum(high,
                                sgt_interval_sum({-N - off - N_err, -N + off + N_err}, sgt_interval_of(-h)));
    }
    double by_parameter() const { return -1; }
};

} // namespace

sgt_objection object_to_geoid_height(const void *self)
{
    return object(*static_cast<const sgt_geoid_height *>(self));
}

} // namespace geo

const sgt_surface_ops sgt_geoid_height_ops = geo::operations<geo::above>::named("geoid");

sgt_geoid *sgt_geoid_open(const char *path, sgt_error *error)
{
    try {
        auto geoid = std::make_unique<sgt_geoid>();
        std::string wrong = geo::read(path, *geoid);
        if (wrong.empty()) return geoid.release();
        geo::say(error, path, wrong);
    } catch (const std::bad_alloc &) {
        geo::say(error, "", "not enough memory for a geoid");
    }
    return nullptr;
}

void sgt_geoid_close(sgt_geoid *geoid) { delete geoid; }

bool sgt_geoid_find(char *path, size_t size, sgt_error *error)
{
    const char *wrong = "the default grid, egm96_15.gtx of proj-data, is not installed";
    const char *folders[] = {std::getenv("PROJ_DATA"), std::getenv("PROJ_LIB"), SGT_PROJ_DATA,
                             "/usr/share/proj", "/usr/local/share/proj"};
    for (const char *folder : folders) {
        if (!folder || !*folder) continue;
        int n = std::snprintf(path, size, "%s/egm96_15.gtx", folder);
        if (n < 0 || static_cast<size_t>(n) >= size) {
            wrong = "no grid was found in the folders of PROJ whose names are short enough for the path";
            continue;
        }
        if (std::FILE *file = std::fopen(path, "rb")) {
            std::fclose(file);
            return true;
        }
    }
    geo::say(error, "", wrong);
    return false;
}

double sgt_geoid_undulation(const sgt_geoid *geoid, double latitude, double longitude)
{
    if (!geoid || !(std::fabs(latitude) <= 90) || !(std::fabs(longitude) <= 1e6)) return geo::nothing;
    return geo::undulation_at(*geoid, latitude, longitude).N;
}
