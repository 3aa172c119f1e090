// SPDX-License-Identifier: MIT
/* yaml_missing.c - in place of yaml.c where the library is built without libyaml. */
#include "tree.h"

void sgt_read_yaml(source *s)
{
    tree_fail(s, 1, NULL, "YAML cannot be read: this was built without libyaml");
}
