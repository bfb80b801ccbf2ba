#include "assemble/file/input_files.h"

#include "shade/environment/environment.h"
#include "shade/finish/named_brdf.h"

namespace stratum::assemble {

std::vector<std::string> inputFiles(const std::vector<ObjectOptions>& objects, const shade::SceneOptions& scene,
                                    const std::string& printer, const std::string& camera_path) {
    std::vector<std::string> files;
    const auto add = [&files](const std::string& path) {
        if (!path.empty()) files.push_back(path);
    };
    const auto material = [&add](const std::string& text) {
        if (!shade::isBrdfPreset(text)) add(text);
    };
    for (const ObjectOptions& object : objects) {
        add(object.vdb);
        material(object.material.brdf);
        for (const auto& each : object.material.each) material(each.second);
    }
    material(scene.brdf);
    if (!shade::isEnvironmentPreset(scene.env)) add(scene.env);
    add(printer);
    add(camera_path);
    return files;
}

}  // namespace stratum::assemble
