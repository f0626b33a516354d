// A lit square, known exactly, through the public headers alone: irradiance 3 pi on a Lambert
// surface of albedo 1/2 is a radiance of 3/2.
#include <lacuna/lacuna.h>

#include <cmath>
#include <cstdio>
#include <numbers>

int main() {
    const float corners[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
    const std::uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    lacuna::SceneBuilder scene;
    lacuna::SceneBuilder::Material grey;
    grey.baseColour = {.5, .5, .5};
    grey.specular = 0.0;
    lacuna::SceneBuilder::Mesh mesh;
    mesh.positions = corners;
    mesh.triangles = triangles;
    mesh.material = scene.addMaterial(grey);
    scene.addInstance(scene.addMesh(mesh));
    lacuna::SceneBuilder::Lamp sun;
    sun.kind = lacuna::SceneBuilder::Lamp::Kind::Directional;
    const double irradiance = 3.0 * std::numbers::pi;
    sun.intensity = {irradiance, irradiance, irradiance};
    scene.addLamp(sun);
    scene.addCamera({"", lacuna::SceneBuilder::lookAt({0, 0, 1}, {0, 0, 0}), .5, 1.0});

    lacuna::Render render(scene);
    render.option("method", "pt").option("width", 16).option("height", 16).option("iterations", 8);
    const lacuna::Picture picture = render.run();
    double sum = 0.0;
    for (const float value : picture.rgb()) sum += value;
    const double mean = sum / double(picture.rgb().size());
    std::printf("%g\n", mean);
    return std::abs(mean - 1.5) < 1e-3 ? 0 : 1;
}
