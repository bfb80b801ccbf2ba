// A picture of a print in studio light, by the library's own choices.
#include <assemble/ready_scene.h>
#include <shade/film/picture.h>

using namespace stratum;

int main(int, char** argv) {
    assemble::PictureOptions options;
    options.render.width = 160;
    options.render.height = 120;
    const assemble::ReadyScene ready = assemble::readyScene(argv[1], options);
    const shade::RenderResult result = shade::render(*ready.objects.intersector, ready.scene, options.render);
    shade::PictureFile(argv[2]).write(result.film, {}, ready.tone);
}
