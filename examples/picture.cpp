// A picture of a print in studio light, by the library's own choices.
#include <assemble/ready_scene.h>
#include <shade/film/picture.h>

#include <cstdio>

using namespace stratum;

int main(int argc, char** argv) {
    if (argc < 3) return std::fprintf(stderr, "usage: picture PRINT.gcode PICTURE.png\n"), 2;
    assemble::PictureOptions options;
    options.render.width = 160;
    options.render.height = 120;
    const assemble::ReadyScene ready = assemble::readyScene(argv[1], options);
    const shade::RenderResult result = shade::render(*ready.objects.intersector, ready.scene, options.render);
    shade::PictureFile(argv[2]).write(result.film, {}, ready.tone);
}
