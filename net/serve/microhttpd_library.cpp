#include "net/serve/microhttpd_library.h"

namespace gs::net {

MicrohttpdLibrary::MicrohttpdLibrary() {
  SharedLibrary library("libmicrohttpd.so.12");
#define GHOSTSPACE_MICROHTTPD_FIND(name) library.find(#name, name);
  GHOSTSPACE_MICROHTTPD_FUNCTIONS(GHOSTSPACE_MICROHTTPD_FIND)
#undef GHOSTSPACE_MICROHTTPD_FIND
  problem = library.problem();
}

const MicrohttpdLibrary& microhttpd() {
  static const MicrohttpdLibrary library;
  return library;
}

}  // namespace gs::net
