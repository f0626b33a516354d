// A method of one's own: a class derived from Method and a MethodRow that makes it, given to
// Render::add. Link with Lacuna::methods, which has the inner headers. These change from version to
// version; libcore/README.md is their guide.
#pragma once

#include "libcore/methods/registry.h"
