// Lacuna as a library: a scene from a file or from memory in, a picture with its layers out.
//
//     #include <lacuna/lacuna.h>
//
//     lacuna::Render render("door.glb");
//     render.option("width", 640).option("time", 30);
//     const lacuna::Picture picture = render.run();
//     picture.save("door.exr");
//
// Errors are exceptions (error.h). Nothing is printed and no signal is handled. Renders share
// nothing: any number of them may run in one process, one after the other or at once. To add your
// own method, see method.h.
#pragma once

#include "lacuna/error.h"
#include "lacuna/picture.h"
#include "lacuna/render.h"
#include "lacuna/scene_builder.h"
