#include "app/confined/decoder_child.h"

#include "app/base/confinement.h"
#include "app/base/exit_status.h"
#include "app/confined/decoder_channel.h"
#include "render/media/libav.h"

#include <algorithm>
#include <csignal>
#include <cstring>
#include <new>
#include <utility>

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace gs::app {
namespace {

// Limits of a child that the limits of requests do not imply.
constexpr rlim_t kMostMemory = rlim_t{3} << 30, kMostSeconds = 600;

bool limit_resources() {
  const auto set = [](__rlimit_resource which, rlim_t most) {
    const rlimit both{most, most};
    return ::setrlimit(which, &both) == 0;
  };
  // No write may make a file longer, also the shared memory. Sockets have no length.
  bool good = set(RLIMIT_FSIZE, 0) && set(RLIMIT_CORE, 0) && set(RLIMIT_CPU, kMostSeconds);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers need terabytes of address space
  good = good && set(RLIMIT_DATA, kMostMemory);
#endif
  return good;
}

template <class Message>
bool send(const Message& message) {
  return write_bytes(kDecoderSocket, std::as_bytes(std::span(&message, 1)));
}

std::variant<render::Image, render::ImageError> decode(std::span<const std::byte> bytes, const DecodeRequest& request) {
  render::ImageLimits limits;
  limits.file_pixels = static_cast<std::size_t>(request.file_pixels);
  limits.kept_pixels = static_cast<std::size_t>(request.kept_pixels);
  limits.working_bytes = static_cast<std::size_t>(request.working_bytes);
  try {
    return render::decode_image(bytes, limits);
  } catch (const std::bad_alloc&) {
    return render::ImageError{"not enough memory to decode it"};
  }
}

DecodeAnswer answer_of(const std::variant<render::Image, render::ImageError>& decoded) {
  DecodeAnswer answer;
  if (const auto* const error = std::get_if<render::ImageError>(&decoded)) {
    error->message.copy(answer.text, DecodeAnswer::kTextBytes - 1);
  } else {
    const auto& image = std::get<render::Image>(decoded);
    answer = {image.width, image.height, image.components, image.reduction, image.slices, image.cube ? 1u : 0u, {}};
  }
  return answer;
}

// Answers one request. Returns false if the parent ended, or sent what it never sends.
bool answer_request(SharedMemory& input, SharedMemory& result) {
  DecodeRequest request;
  if (!read_bytes(kDecoderSocket, std::as_writable_bytes(std::span(&request, 1)))) return false;
  const std::span<const std::byte> bytes = input.map(static_cast<std::size_t>(request.bytes));
  if (bytes.size() != request.bytes) return false;
  const auto decoded = decode(bytes, request);
  if (!send(answer_of(decoded))) return false;
  const auto* const image = std::get_if<render::Image>(&decoded);
  if (!image) return true;
  std::byte sign{};
  if (!read_bytes(kDecoderSocket, {&sign, 1})) return false;
  const std::span<std::byte> to = result.map(image->pixels.size());
  if (to.size() != image->pixels.size()) return false;
  std::memcpy(to.data(), image->pixels.data(), to.size());
  return send(sign);
}

}  // namespace

std::string_view name_of(DecoderKind kind) { return kind == DecoderKind::movies ? "movies" : "pictures"; }

void run_decoder_child(std::string_view kind) {
  (void)std::signal(SIGPIPE, SIG_IGN);
  (void)std::signal(SIGINT, SIG_IGN);  // Ctrl-C on the terminal is for the parent
  (void)::prctl(PR_SET_DUMPABLE, 0);
  if (kind == name_of(DecoderKind::movies)) (void)render::libav();
  if (!limit_resources() || confine_decoder()) ::_exit(kFailed);
  SharedMemory input(net::Descriptor(kDecoderInput), false), result(net::Descriptor(kDecoderResult), true);
  while (answer_request(input, result)) {
  }
  ::_exit(kDone);  // destructors and leak checks need calls that are refused now
}

}  // namespace gs::app
