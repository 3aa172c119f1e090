// SPDX-License-Identifier: MIT
// as_batch.h - rays asked as one batch, to be compared with each asked alone.
#ifndef TESTS_CATALOGUE_AS_BATCH_H
#define TESTS_CATALOGUE_AS_BATCH_H

#include "../ends.h"

#include <sagitta/sagitta.h>

#include <cstddef>
#include <cstring>
#include <vector>

namespace catalogue {

class as_batch {
public:
    as_batch(sgt_surface s, const std::vector<sgt_ray> &rays)
        : status(rays.size()), evals(rays.size()), t(rays.size()), t_err(rays.size())
    {
        std::vector<double> in[8];
        for (const sgt_ray &r : rays) {
            const double of[] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, end_of(&r)};
            for (int k = 0; k < 8; k++) in[k].push_back(of[k]);
        }
        sgt_hits hits = {};
        hits.status = status.data(), hits.evals = evals.data(), hits.t = t.data(), hits.t_err = t_err.data();
        sgt_intersect_batch(s, rays.size(),
                            {{in[0].data(), in[1].data(), in[2].data()},
                             {in[3].data(), in[4].data(), in[5].data()},
                             in[6].data(),
                             in[7].data()},
                            hits, nullptr);
    }
    // Is the answer to ray i this one of the ray alone, to the last bit?
    bool same(std::size_t i, const sgt_hit &one) const
    {
        return one.status == status[i] && one.evals == evals[i] &&
               (one.status <= 0 || (std::memcmp(&one.t, &t[i], sizeof t[i]) == 0 &&
                                    std::memcmp(&one.t_err, &t_err[i], sizeof t_err[i]) == 0));
    }
    std::vector<sgt_status> status;
    std::vector<int> evals;
    std::vector<double> t, t_err;
};

} // namespace catalogue
#endif
