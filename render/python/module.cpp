// lacuna._lacuna: the Python binding of the library. Users use lacuna/__init__.py instead.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <thread>

#include "lacuna/lacuna.h"
#include "lacuna/method.h"

namespace lacuna {
namespace {

namespace py = pybind11;
using namespace py::literals;

template <class T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

template <class T>
std::span<const T> spanOf(const Array<T>& array) {
    return {array.data(), std::size_t(array.size())};
}
template <class T>
std::span<const T> spanOf(const std::optional<Array<T>>& array) {
    return array ? spanOf(*array) : std::span<const T>();
}

/// A read-only view of the picture's pixels. It keeps the picture alive.
py::array view(py::handle picture, std::span<const float> values,
               const std::vector<py::ssize_t>& shape) {
    py::array_t<float> array(shape, values.data(), picture);
    array.attr("flags").attr("writeable") = false;
    return array;
}

/// The argument of callbacks: RenderProgress, valid while the callback runs.
struct Now {
    RenderProgress progress;
    bool over = false;

    py::object preview() const {
        if (over || !progress.preview) return py::none();
        const RenderProgress::Preview preview = progress.preview();
        py::array_t<float> array({preview.height, preview.width, 3});
        std::copy(preview.rgb.begin(), preview.rgb.end(), array.mutable_data());
        return array;
    }
};

/// Runs the render in another thread, so that this one can check for Ctrl-C.
Picture runWatched(Render& render) {
    std::stop_source stop;
    std::optional<Picture> picture;
    std::exception_ptr failure;
    std::mutex mutex;
    std::condition_variable ended;
    bool done = false;
    // The exception of a signal handler: KeyboardInterrupt, or that of a user's handler.
    std::optional<py::error_already_set> raised;
    std::thread worker([&] {
        try {
            picture = render.run(stop.get_token());
        } catch (...) {
            failure = std::current_exception();
        }
        const std::lock_guard lock(mutex);
        done = true;
        ended.notify_all();
    });
    {
        const py::gil_scoped_release release;
        std::unique_lock lock(mutex);
        while (!ended.wait_for(lock, std::chrono::milliseconds(50), [&] { return done; })) {
            lock.unlock();
            {
                const py::gil_scoped_acquire acquire;
                if (!raised && PyErr_CheckSignals() != 0) {
                    raised.emplace();
                    stop.request_stop();
                }
            }
            lock.lock();
        }
        lock.unlock();
        worker.join();
    }
    if (raised) throw *raised;
    if (failure) std::rethrow_exception(failure);
    return *picture;
}

using Texts = std::vector<std::pair<std::string, std::string>>;

Picture render(const std::variant<std::string, SceneBuilder*>& scene, const Texts& options,
               const std::vector<std::string>& flags, const Texts& settings,
               const py::object& onProgress, const py::object& onWarning) {
    Render render = std::holds_alternative<std::string>(scene)
                        ? Render(std::get<std::string>(scene))
                        : Render(*std::get<SceneBuilder*>(scene));
    for (const auto& [name, value] : options) render.option(name, value);
    for (const std::string& name : flags) render.option(name, true);
    for (const auto& [key, value] : settings) render.set(key, value);
    if (!onProgress.is_none()) {
        render.onProgress([&](const RenderProgress& progress) {
            const py::gil_scoped_acquire acquire;
            const auto now = std::make_shared<Now>(Now{progress});
            onProgress(now);
            now->over = true;
        });
    }
    render.onWarning([&](const std::string& text) {
        const py::gil_scoped_acquire acquire;
        onWarning(text);
    });
    return runWatched(render);
}

Picture pictureOf(const Array<float>& rgb) {
    if (rgb.ndim() != 3 || rgb.shape(2) != 3) {
        throw UsageError("Image: expected an array (height, width, 3), found another shape");
    }
    return Picture(int(rgb.shape(1)), int(rgb.shape(0)), spanOf(rgb));
}

py::list methodList() {
    py::list list;
    for (const MethodRow& row : methods()) {
        py::dict parameters;
        for (const Option& option : row.options) {
            parameters[py::str(option.name)] = option.shownDefault();
        }
        list.append(py::dict("name"_a = row.name, "summary"_a = row.summary,
                             "reference"_a = row.reference, "parameters"_a = parameters));
    }
    return list;
}

void bindErrors(py::module_& module) {
    static py::exception<Error> error(module, "Error", PyExc_RuntimeError);
    static py::exception<UsageError> usage(module, "UsageError", error.ptr());
    static py::exception<InputError> input(module, "InputError", error.ptr());
    static py::exception<RunError> run(module, "RunError", error.ptr());
    static py::exception<InterruptedError> interrupted(module, "Interrupted", error.ptr());
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const UsageError& e) {
            usage(e.what());
        } catch (const InputError& e) {
            input(e.what());
        } catch (const RunError& e) {
            run(e.what());
        } catch (const InterruptedError& e) {
            interrupted(e.what());
        } catch (const Error& e) {
            error(e.what());
        }
    });
}

void bindPicture(py::module_& module) {
    py::class_<Now, std::shared_ptr<Now>>(module, "Progress")
        .def_property_readonly("phase", [](const Now& n) { return n.progress.phase; })
        .def_property_readonly("iterations", [](const Now& n) { return n.progress.iterations; })
        .def_property_readonly("limit", [](const Now& n) { return n.progress.limit; })
        .def_property_readonly("seconds", [](const Now& n) { return n.progress.seconds; })
        .def_property_readonly("time_limit", [](const Now& n) { return n.progress.timeLimit; })
        .def_property_readonly("accuracy", [](const Now& n) { return n.progress.accuracy; })
        .def("preview", &Now::preview);

    py::class_<Picture>(module, "Picture")
        .def(py::init(&pictureOf))
        .def_static("load", &Picture::load, py::call_guard<py::gil_scoped_release>())
        .def_property_readonly("width", &Picture::width)
        .def_property_readonly("height", &Picture::height)
        .def_property_readonly("rgb",
                               [](const py::object& self) {
                                   const auto& p = self.cast<const Picture&>();
                                   return view(self, p.rgb(), {p.height(), p.width(), 3});
                               })
        .def("channels", &Picture::channels)
        .def("channel",
             [](const py::object& self, const std::string& name) {
                 const auto& p = self.cast<const Picture&>();
                 return view(self, p.channel(name), {p.height(), p.width()});
             })
        .def("statistics", &Picture::statistics)
        .def("save", &Picture::save, py::call_guard<py::gil_scoped_release>())
        .def("relight", &Picture::relight, py::call_guard<py::gil_scoped_release>())
        .def("compare", [](const Picture& picture, const Picture& reference) {
            const Errors e = picture.compare(reference);
            return py::dict("mae"_a = e.mae, "rmse"_a = e.rmse, "mape"_a = e.mape,
                            "relmse"_a = e.relmse);
        });
}

void bindScene(py::module_& module) {
    using Builder = SceneBuilder;
    py::class_<Builder> scene(module, "SceneBuilder");
    using M = Builder::Material;
    py::enum_<M::Alpha>(scene, "Alpha")
        .value("opaque", M::Alpha::Opaque)
        .value("mask", M::Alpha::Mask)
        .value("blend", M::Alpha::Blend);
    py::class_<M>(scene, "Material")
        .def(py::init<>())
        .def_readwrite("name", &M::name)
        .def_readwrite("base_colour", &M::baseColour)
        .def_readwrite("alpha", &M::alpha)
        .def_readwrite("metallic", &M::metallic)
        .def_readwrite("roughness", &M::roughness)
        .def_readwrite("specular", &M::specular)
        .def_readwrite("ior", &M::ior)
        .def_readwrite("transmission", &M::transmission)
        .def_readwrite("solid", &M::solid)
        .def_readwrite("attenuation", &M::attenuation)
        .def_readwrite("attenuation_distance", &M::attenuationDistance)
        .def_readwrite("clearcoat", &M::clearcoat)
        .def_readwrite("clearcoat_roughness", &M::clearcoatRoughness)
        .def_readwrite("sheen", &M::sheen)
        .def_readwrite("sheen_roughness", &M::sheenRoughness)
        .def_readwrite("anisotropy", &M::anisotropy)
        .def_readwrite("anisotropy_rotation", &M::anisotropyRotation)
        .def_readwrite("diffuse_transmission", &M::diffuseTransmission)
        .def_readwrite("diffuse_transmission_colour", &M::diffuseTransmissionColour)
        .def_readwrite("emission", &M::emission)
        .def_readwrite("double_sided", &M::doubleSided)
        .def_readwrite("alpha_mode", &M::alphaMode)
        .def_readwrite("alpha_cutoff", &M::alphaCutoff)
        .def_readwrite("base_colour_texture", &M::baseColourTexture)
        .def_readwrite("metallic_roughness_texture", &M::metallicRoughnessTexture)
        .def_readwrite("normal_texture", &M::normalTexture)
        .def_readwrite("normal_scale", &M::normalScale)
        .def_readwrite("emission_texture", &M::emissionTexture)
        .def_readwrite("transmission_texture", &M::transmissionTexture);
    scene.def(py::init<>())
        .def_static("look_at", &Builder::lookAt, "eye"_a, "target"_a,
                    "up"_a = Builder::Point{0, 1, 0})
        .def("add_texture",
             [](Builder& self, const Array<std::uint8_t>& rgba) {
                 if (rgba.ndim() != 3 || rgba.shape(2) != 4) {
                     throw UsageError(
                         "add_texture: expected an array (height, width, 4), found another shape");
                 }
                 return self.addTexture(int(rgba.shape(1)), int(rgba.shape(0)), spanOf(rgba));
             })
        .def("add_material", &Builder::addMaterial)
        .def(
            "add_mesh",
            [](Builder& self, const Array<float>& positions, const Array<std::uint32_t>& triangles,
               const std::optional<Array<float>>& normals, const std::optional<Array<float>>& uvs,
               const std::optional<Array<float>>& colours, std::optional<Builder::Index> material) {
                return self.addMesh({spanOf(positions), spanOf(triangles), spanOf(normals),
                                     spanOf(uvs), spanOf(colours), material});
            })
        .def("add_instance", &Builder::addInstance)
        .def("add_camera",
             [](Builder& self, const std::string& name, const Builder::Transform& toWorld,
                double yfov, double aspect) {
                 self.addCamera({name, toWorld, yfov, aspect});
             })
        .def("add_lamp",
             [](Builder& self, const std::string& kind, const Builder::Colour& intensity,
                const Builder::Transform& toWorld, double inner, double outer) {
                 using Kind = Builder::Lamp::Kind;
                 const auto kindOf = [&] {
                     if (kind == "point") return Kind::Point;
                     if (kind == "spot") return Kind::Spot;
                     if (kind == "directional") return Kind::Directional;
                     throw UsageError("add_lamp: expected point, spot or directional, found '" +
                                      kind + "'");
                 };
                 self.addLamp({kindOf(), intensity, toWorld, inner, outer});
             })
        .def("glb",
             [](const Builder& self) {
                 const std::vector<std::uint8_t> bytes = self.glb();
                 return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
             })
        .def("save", &Builder::save);
}

PYBIND11_MODULE(_lacuna, module) {
    module.doc() = "The inside of the package lacuna.";
    module.attr("__version__") = LACUNA_VERSION;
    bindErrors(module);
    bindPicture(module);
    bindScene(module);
    module.def("render", &render, "scene"_a, "options"_a, "flags"_a, "settings"_a, "on_progress"_a,
               "on_warning"_a);
    module.def("methods", &methodList);
}

}  // namespace
}  // namespace lacuna
