// Shared library that is loaded before the program starts (LD_PRELOAD). It sets the locale of the
// environment for C and C++, which the program itself does not do, as a host application might.
// Every process writes to the file FLEXMORPH_SPEAKS how it prints and reads numbers.
#include <cstdio>
#include <cstdlib>
#include <locale>
#include <sstream>

namespace {

struct Speak {
  Speak() {
    std::locale::global(std::locale(""));
    std::ostringstream streamed;
    streamed << 1234.5;
    const char* name = std::getenv("FLEXMORPH_SPEAKS");
    if (std::FILE* file = name ? std::fopen(name, "a") : nullptr) {
      std::fprintf(file, "printf %.1f strtod %d stream %s\n", 0.5,
                   static_cast<int>(1000 * std::strtod("0,25", nullptr)), streamed.str().c_str());
      std::fclose(file);
    }
  }
} speak;

}  // namespace
