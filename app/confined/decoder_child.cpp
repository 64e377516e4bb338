#include "app/confined/decoder_child.h"

#include "app/base/confinement.h"
#include "app/base/exit_status.h"
#include "app/confined/child_channel.h"
#include "render/media/libav.h"
#include "render/media/movie.h"
#include "render/media/sample_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace gs::app {
namespace {

// Limits of a child that the limits of requests do not imply.
constexpr rlim_t kMostSeconds = 600, kMostDataSeconds = 100'000;  // data may stay open for long

bool limit_resources(rlim_t memory, rlim_t seconds) {
  const auto set = [](__rlimit_resource which, rlim_t most) {
    const rlimit both{most, most};
    return ::setrlimit(which, &both) == 0;
  };
  // No write may make a file longer, also the shared memory. Sockets have no length.
  bool good = set(RLIMIT_FSIZE, 0) && set(RLIMIT_CORE, 0) && set(RLIMIT_CPU, seconds);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers need terabytes of address space
  good = good && set(RLIMIT_DATA, memory);
#endif
  return good;
}

using Decoded = std::variant<render::Image, render::ImageError>;

/// Decoders of a child, with the movie or the sound that is open. One thread.
class DecoderServer {
 public:
  explicit DecoderServer(ImportFile import_file) : import_file_(import_file) {}
  /// Answers one request. Returns false if the parent ended, or sent what it never sends.
  bool answer_request();

 private:
  /// Carries out a request. Sets `image` if the result has one.
  void carry_out(const DecodeRequest& request, std::span<const std::byte> bytes, DecodeAnswer& answer, Decoded& image);
  void examine(std::span<const std::byte> bytes, DecodeAnswer& answer);
  void open_movie(std::span<const std::byte> bytes, const render::ImageLimits& limits, DecodeAnswer& answer);
  void open_sound(std::span<const std::byte> bytes, double rate, DecodeAnswer& answer);
  void read_sound(std::uint64_t pairs, DecodeAnswer& answer);
  void import(const DecodeRequest& request, std::span<const std::byte> bytes, DecodeAnswer& answer);
  [[nodiscard]] Decoded movie_at(const DecodeRequest& request, DecodeAnswer& answer);

  SharedMemory input_{net::Descriptor(kDecoderInput), false}, result_{net::Descriptor(kDecoderResult), true};
  ImportFile import_file_;
  std::vector<std::byte> imported_;  // result of the last import
  std::unique_ptr<render::Movie> movie_;
  std::unique_ptr<render::SampleReader> sound_;
};

void DecoderServer::examine(std::span<const std::byte> bytes, DecodeAnswer& answer) {
  const auto found = render::examine_media(bytes);
  if (const auto* const error = std::get_if<render::MediaError>(&found)) return set_error(answer, error->message);
  const auto& info = std::get<render::MediaInfo>(found);
  answer.good = 1;
  answer.pictures = info.pictures ? 1 : 0;
  answer.sound = info.sound ? 1 : 0;
  answer.seconds = info.duration;
}

void DecoderServer::open_movie(std::span<const std::byte> bytes, const render::ImageLimits& limits,
                               DecodeAnswer& answer) {
  movie_.reset();
  auto opened = render::Movie::open(bytes, limits);
  if (const auto* const error = std::get_if<render::ImageError>(&opened)) return set_error(answer, error->message);
  movie_ = std::move(std::get<std::unique_ptr<render::Movie>>(opened));
  answer.good = 1;
}

Decoded DecoderServer::movie_at(const DecodeRequest& request, DecodeAnswer& answer) {
  if (!movie_) return render::ImageError{"no movie is open"};
  auto found = movie_->at(request.seconds);
  if (auto* const error = std::get_if<render::ImageError>(&found)) return std::move(*error);
  const auto* const frame = std::get<const render::Movie::Frame*>(found);
  if (!frame) return render::ImageError{"it has no pictures"};
  answer.good = 1;
  answer.seconds = frame->time;
  if (frame->time == request.known) return render::ImageError{};
  return frame->image;
}

void DecoderServer::open_sound(std::span<const std::byte> bytes, double rate, DecodeAnswer& answer) {
  sound_.reset();
  auto opened = render::open_samples(bytes, rate);
  if (const auto* const error = std::get_if<render::MediaError>(&opened)) return set_error(answer, error->message);
  sound_ = std::move(std::get<std::unique_ptr<render::SampleReader>>(opened));
  answer.good = 1;
  answer.seconds = sound_->rate();
  answer.count = static_cast<std::uint64_t>(sound_->channels());
}

void DecoderServer::read_sound(std::uint64_t pairs, DecodeAnswer& answer) {
  std::vector<float> samples(static_cast<std::size_t>(std::min(pairs, kMostPairs)) * 2);
  const auto to = result_.map(samples.size() * sizeof(float));
  if (!sound_ || to.size() < samples.size() * sizeof(float)) return set_error(answer, "no sound is open");
  answer.count = sound_->read(samples);
  std::ranges::copy(std::as_bytes(std::span(samples).first(static_cast<std::size_t>(answer.count) * 2)), to.begin());
  answer.good = 1;
}

void DecoderServer::import(const DecodeRequest& request, std::span<const std::byte> bytes, DecodeAnswer& answer) {
  if (!import_file_ || request.count > bytes.size()) return set_error(answer, "it cannot be imported");
  const auto head = static_cast<std::size_t>(request.count);
  imported_ = import_file_(bytes.first(head), bytes.subspan(head),
                           [this](const std::string& reference) { return ask_parent_for_file(result_, reference); });
  answer.good = 1;
  answer.count = imported_.size();
}

void DecoderServer::carry_out(const DecodeRequest& request, std::span<const std::byte> bytes, DecodeAnswer& answer,
                              Decoded& image) {
  render::ImageLimits limits;
  limits.file_pixels = static_cast<std::size_t>(request.file_pixels);
  limits.kept_pixels = static_cast<std::size_t>(request.kept_pixels);
  limits.working_bytes = static_cast<std::size_t>(request.working_bytes);
  switch (request.operation) {
    case DecodeOperation::picture:
      image = render::decode_image(bytes, limits);
      return;
    case DecodeOperation::examine:
      return examine(bytes, answer);
    case DecodeOperation::open_movie:
      return open_movie(bytes, limits, answer);
    case DecodeOperation::movie_at:
      image = movie_at(request, answer);
      return;
    case DecodeOperation::open_sound:
      return open_sound(bytes, request.seconds, answer);
    case DecodeOperation::read_sound:
      return read_sound(request.count, answer);
    case DecodeOperation::seek_sound:
      if (!sound_) return set_error(answer, "no sound is open");
      sound_->seek(request.seconds);
      answer.good = 1;
      return;
    case DecodeOperation::import_file:
      return import(request, bytes, answer);
    case DecodeOperation::give_file:
    case DecodeOperation::open_data:
    case DecodeOperation::read_slices:
    case DecodeOperation::read_box:
      return set_error(answer, "this child does other work");
  }
}

bool DecoderServer::answer_request() {
  DecodeRequest request;
  if (!receive_request(request)) return false;
  const bool continues = request.operation == DecodeOperation::movie_at ||
                         request.operation == DecodeOperation::read_sound ||
                         request.operation == DecodeOperation::seek_sound;
  if (!continues) {
    // The memory is mapped anew, so nothing may use the old bytes.
    movie_.reset();
    sound_.reset();
    imported_ = {};
  }
  const std::span<const std::byte> bytes = input_.map(static_cast<std::size_t>(request.bytes));
  if (bytes.size() != request.bytes) return false;
  DecodeAnswer answer;
  Decoded image = render::ImageError{};
  try {
    carry_out(request, bytes, answer, image);
  } catch (const std::bad_alloc&) {
    set_error(answer, "not enough memory to decode it");
  }
  if (const auto* const decoded = std::get_if<render::Image>(&image)) {
    answer.width = decoded->width;
    answer.height = decoded->height;
    answer.components = decoded->components;
    answer.reduction = decoded->reduction;
    answer.slices = decoded->slices;
    answer.cube = decoded->cube ? 1 : 0;
  } else if (const std::string& message = std::get<render::ImageError>(image).message; !message.empty()) {
    set_error(answer, message);
  }
  if (!send_answer(answer)) return false;
  if (const auto* const decoded = std::get_if<render::Image>(&image))
    return send_results(result_, std::as_bytes(std::span(decoded->pixels)));
  return request.operation != DecodeOperation::import_file || answer.good != 1 || send_results(result_, imported_);
}

}  // namespace

std::string_view name_of(DecoderKind kind) {
  static constexpr std::array<std::string_view, kDecoderKinds> kNames = {"pictures", "movies", "volumes", "datasets",
                                                                        "dataset_meshes"};
  return kNames[static_cast<std::size_t>(kind)];
}

void run_decoder_child(std::string_view kind, std::string_view mebibytes, const DecoderWork& work) {
  (void)std::signal(SIGPIPE, SIG_IGN);
  (void)std::signal(SIGINT, SIG_IGN);  // Ctrl-C on the terminal is for the parent
  (void)::prctl(PR_SET_DUMPABLE, 0);
  if (kind == name_of(DecoderKind::movies)) (void)render::libav();
  const bool has_datasets = kind == name_of(DecoderKind::datasets);
  if ((has_datasets || kind == name_of(DecoderKind::dataset_meshes)) && work.load_datasets) work.load_datasets();
  const bool serves_data = has_datasets || kind == name_of(DecoderKind::volumes);
  std::uint64_t memory = 0;
  const auto [end, error] = std::from_chars(mebibytes.data(), mebibytes.data() + mebibytes.size(), memory);
  constexpr std::uint64_t kMost = std::uint64_t{1} << 40;  // 2^60 bytes
  if (error != std::errc() || end != mebibytes.data() + mebibytes.size() || memory > kMost) ::_exit(kFailed);
  if (!limit_resources(memory << 20, serves_data ? kMostDataSeconds : kMostSeconds) || confine_decoder())
    ::_exit(kFailed);
  if (serves_data && work.open_volume) serve_data(*work.open_volume());
  if (!serves_data) {
    DecoderServer server(work.import_file);
    while (server.answer_request()) {
    }
  }
  ::_exit(kDone);  // destructors and leak checks need calls that are refused now
}

}  // namespace gs::app
