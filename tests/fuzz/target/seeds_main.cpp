// fuzz_seeds DIRECTORY: writes the files that fuzzing starts from, a folder for each parser.
#include <cstdio>

#include "tests/fuzz/seeds.h"

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: fuzz_seeds DIRECTORY\n");
        return 2;
    }
    lacuna::test::writeSeeds(argv[1]);
}
