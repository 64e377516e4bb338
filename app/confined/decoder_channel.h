#pragma once

#include "net/base/descriptor.h"
#include "render/image/image.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

namespace gs::app {

/// Descriptors of a decoder child. The parent creates them all.
enum DecoderDescriptor : int { kDecoderSocket = 3, kDecoderInput = 4, kDecoderResult = 5 };

/// Work of a child. Operations after an `open_` one continue with its movie or sound.
enum class DecodeOperation : std::uint32_t {
  picture,      // decodes an image, or the first picture of a movie
  examine,      // finds out the playable contents and the duration of a sound or movie
  open_movie,   // opens a movie
  movie_at,     // decodes the picture of the movie at `seconds`
  open_sound,   // opens the sound of a sound or movie; `seconds` is the rate of synthesis
  read_sound,   // reads up to `count` pairs of samples into the memory for results
  seek_sound,   // seeks to `seconds`
  import_file,  // imports a file; the first `count` bytes are the request
  give_file,    // answers kAsksForFile: `count` tells what is given; `bytes` bytes of it are in the results
  open_data,    // opens the file in the input memory; the first `count` bytes of results are the request
  read_slices,  // reads `count` slices of `source` from `first` on, of `bytes` bytes each, to `offset` in the results
  read_box,     // reads the voxels of `box` of `source`, `bytes` bytes in all, into the results
};

/// Most pairs of samples that one request reads.
inline constexpr std::uint64_t kMostPairs = 1 << 16;

/// Request of the parent. The bytes to decode lie at the start of the input memory.
struct DecodeRequest {
  static constexpr std::uint64_t kGivenError = 0, kGivenBytes = 1, kGivenDescriptor = 2;  // values of `count`
  DecodeOperation operation = DecodeOperation::picture;
  std::uint64_t bytes = 0;
  std::uint64_t file_pixels = 0, kept_pixels = 0, working_bytes = 0;  // render::ImageLimits
  double seconds = 0;
  double known = -1;  // of movie_at: time of the picture that the parent has, which is not sent again
  std::uint64_t count = 0;
  std::uint64_t source = 0, first = 0, offset = 0;  // of read_slices
  std::array<std::uint32_t, 9> box{};               // of read_box: first voxel, size and steps
};

/// First answer of the child. If there is an image, the parent makes room for its pixels in the memory for results and
/// writes a byte. Then the child copies them there and answers with a byte.
struct DecodeAnswer {
  static constexpr std::size_t kTextBytes = 400;
  static constexpr std::uint32_t kAsksForFile = 2;  // value of `good`: needs the file that `text` names
  std::uint32_t width = 0, height = 0, components = 0, reduction = 0, slices = 0;  // all 0 if there is no image
  std::uint32_t cube = 0;
  std::uint32_t good = 0;                 // 1 if the operation succeeded
  std::uint32_t pictures = 0, sound = 0;  // of examine
  double seconds = 0;                     // duration of examine; time of a picture; rate of a sound in Hz
  std::uint64_t count = 0;                // channels of open_sound; pairs of read_sound; slices of read_slices
  char text[kTextBytes] = {};             // the error, ended by a 0
};

/// Writes all bytes to a descriptor. Returns false if the other end is closed.
[[nodiscard]] bool write_bytes(int file, std::span<const std::byte> bytes);
/// Reads exactly these bytes from a descriptor. Returns false if it ends.
[[nodiscard]] bool read_bytes(int file, std::span<std::byte> bytes);

/// Sends an open descriptor to the other end of a socket, with one byte. Returns false if that is closed.
[[nodiscard]] bool send_descriptor(int socket, int descriptor);
/// Receives what send_descriptor() sends; nothing if there is no descriptor.
[[nodiscard]] net::Descriptor receive_descriptor(int socket);

/// Memory that two processes map, in a file without a name. It grows and never shrinks.
class SharedMemory {
 public:
  SharedMemory() = default;
  /// Uses the file of another process.
  explicit SharedMemory(net::Descriptor file, bool writable) : file_(std::move(file)), writable_(writable) {}
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&& other) noexcept;
  ~SharedMemory();
  /// Creates an empty file that cannot shrink. Returns nullopt and sets errno on failure.
  [[nodiscard]] static std::optional<SharedMemory> create();

  /// Makes the file at least this long. Only its creator can do this. Returns false if memory is insufficient.
  [[nodiscard]] bool grow(std::size_t bytes);
  /// Returns the first bytes of the file, or an empty span if they cannot be mapped. The file must have them. The span
  /// is valid until the next call.
  [[nodiscard]] std::span<std::byte> map(std::size_t bytes);
  [[nodiscard]] int file() const { return file_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void unmap();

  net::Descriptor file_;
  bool writable_ = true;
  std::size_t size_ = 0;  // bytes that grow() added to the file
  void* at_ = nullptr;
  std::size_t mapped_ = 0;
};

/// Returns a request for `bytes` bytes.
[[nodiscard]] DecodeRequest request_of(DecodeOperation operation, std::size_t bytes,
                                       const render::ImageLimits& limits = {});
/// Returns the error in an answer. Control characters are replaced.
[[nodiscard]] std::string error_in(const DecodeAnswer& answer);
/// Returns the image of an answer, without its pixels, or the error in it. Trusts nothing: an image has 1 to 4
/// components, at most `kept_pixels` pixels and possible slices.
[[nodiscard]] std::variant<render::Image, render::ImageError> check_answer(const DecodeAnswer& answer,
                                                                           const DecodeRequest& request);

}  // namespace gs::app
