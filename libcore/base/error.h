// The errors are part of the library's public headers.
#pragma once

#include "lacuna/error.h"
