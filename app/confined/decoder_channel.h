#pragma once

#include "net/base/descriptor.h"
#include "render/image/image.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

namespace gs::app {

/// Descriptors of a decoder child. The parent creates them all.
enum DecoderDescriptor : int { kDecoderSocket = 3, kDecoderInput = 4, kDecoderResult = 5 };

/// Request of the parent. The bytes to decode lie at the start of the input memory.
struct DecodeRequest {
  std::uint64_t bytes = 0;
  std::uint64_t file_pixels = 0, kept_pixels = 0, working_bytes = 0;  // render::ImageLimits
};

/// First answer of the child. If there is an image, the parent makes room for its pixels in the memory for results and
/// writes a byte. Then the child copies them there and answers with a byte.
struct DecodeAnswer {
  static constexpr std::size_t kTextBytes = 400;
  std::uint32_t width = 0, height = 0, components = 0, reduction = 0, slices = 0;  // all 0 after an error
  std::uint32_t cube = 0;
  char text[kTextBytes] = {};  // the error, ended by a 0
};

/// Writes all bytes to a descriptor. Returns false if the other end is closed.
[[nodiscard]] bool write_bytes(int file, std::span<const std::byte> bytes);
/// Reads exactly these bytes from a descriptor. Returns false if it ends.
[[nodiscard]] bool read_bytes(int file, std::span<std::byte> bytes);

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

/// Returns the image of an answer, without its pixels, or the error in it. Trusts nothing: an image has 1 to 4
/// components, at most `kept_pixels` pixels and possible slices. Control characters in a text are replaced.
[[nodiscard]] std::variant<render::Image, render::ImageError> check_answer(const DecodeAnswer& answer,
                                                                           const DecodeRequest& request);

}  // namespace gs::app
