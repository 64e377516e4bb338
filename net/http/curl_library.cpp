#include "net/http/curl_library.h"

namespace gs::net {

CurlLibrary::CurlLibrary() {
  SharedLibrary library("libcurl.so.4");
#define GHOSTSPACE_CURL_FIND(name) library.find(#name, name);
  GHOSTSPACE_CURL_FUNCTIONS(GHOSTSPACE_CURL_FIND)
#undef GHOSTSPACE_CURL_FIND
  problem = library.problem();
}

const CurlLibrary& curl() {
  static const CurlLibrary library;
  return library;
}

}  // namespace gs::net
