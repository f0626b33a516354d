// To add your own method, derive a class from Method and give Render::add a MethodRow that makes
// it. Link with Lacuna::methods, which has the internal headers. These change from version to
// version; libcore/README.md is the guide to them.
#pragma once

#include "libcore/methods/registry.h"
