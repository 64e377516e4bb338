#include "render/media/libav.h"

#include <dlfcn.h>

namespace gs::render {
namespace {

constexpr std::size_t kMaxAtOnce = std::size_t{1} << 29;  // maximum bytes of one allocation by FFmpeg

}  // namespace

Libav::Libav() {
  void* const avutil = open("libavutil.so." AV_STRINGIFY(LIBAVUTIL_VERSION_MAJOR));
  void* const avcodec = open("libavcodec.so." AV_STRINGIFY(LIBAVCODEC_VERSION_MAJOR));
  void* const avformat = open("libavformat.so." AV_STRINGIFY(LIBAVFORMAT_VERSION_MAJOR));
  void* const swscale = open("libswscale.so." AV_STRINGIFY(LIBSWSCALE_VERSION_MAJOR));
  if (!problem.empty()) return;
#define GHOSTSPACE_LIBAV_FIND(library, name)                      \
  name = reinterpret_cast<decltype(name)>(dlsym(library, #name)); \
  if (!name) problem = "the library has no " #name;
  GHOSTSPACE_LIBAV_FUNCTIONS(GHOSTSPACE_LIBAV_FIND)
#undef GHOSTSPACE_LIBAV_FIND
  if (!problem.empty()) return;
  av_log_set_level(AV_LOG_QUIET);
  av_max_alloc(kMaxAtOnce);
}

void* Libav::open(const char* name) {
  void* const handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);
  if (!handle && problem.empty()) problem = std::string(name) + " cannot be opened";
  return handle;
}

const Libav& libav() {
  static const Libav library;
  return library;
}

}  // namespace gs::render
