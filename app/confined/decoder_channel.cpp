#include "app/confined/decoder_channel.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

namespace gs::app {

bool write_bytes(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

bool read_bytes(int file, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::read(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

bool send_descriptor(int socket, int descriptor) {
  std::byte sign{1};
  iovec part{&sign, 1};
  alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(int))> room{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = room.data();
  message.msg_controllen = room.size();
  cmsghdr* const head = CMSG_FIRSTHDR(&message);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof(int));
  std::memcpy(CMSG_DATA(head), &descriptor, sizeof descriptor);
  ssize_t sent = 0;
  do sent = ::sendmsg(socket, &message, MSG_NOSIGNAL);
  while (sent < 0 && errno == EINTR);
  return sent == 1;
}

net::Descriptor receive_descriptor(int socket) {
  std::byte sign{};
  iovec part{&sign, 1};
  alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(int))> room{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = room.data();
  message.msg_controllen = room.size();
  ssize_t got = 0;
  do got = ::recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
  while (got < 0 && errno == EINTR);
  const cmsghdr* const head = got == 1 ? CMSG_FIRSTHDR(&message) : nullptr;
  if (!head || head->cmsg_level != SOL_SOCKET || head->cmsg_type != SCM_RIGHTS ||
      head->cmsg_len != CMSG_LEN(sizeof(int)))
    return {};
  int descriptor = -1;
  std::memcpy(&descriptor, CMSG_DATA(head), sizeof descriptor);
  return net::Descriptor(descriptor);
}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept
    : file_(std::move(other.file_)),
      writable_(other.writable_),
      size_(std::exchange(other.size_, 0)),
      at_(std::exchange(other.at_, nullptr)),
      mapped_(std::exchange(other.mapped_, 0)) {}

SharedMemory& SharedMemory::operator=(SharedMemory&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(writable_, other.writable_);
  std::swap(size_, other.size_);
  std::swap(at_, other.at_);
  std::swap(mapped_, other.mapped_);
  return *this;
}

SharedMemory::~SharedMemory() { unmap(); }

std::optional<SharedMemory> SharedMemory::create() {
  net::Descriptor file(::memfd_create("decoder", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  // Without shrinking, an access to mapped memory cannot fail.
  if (!file || ::fcntl(file.get(), F_ADD_SEALS, F_SEAL_SHRINK) != 0) return std::nullopt;
  return SharedMemory(std::move(file), true);
}

bool SharedMemory::grow(std::size_t bytes) {
  if (bytes <= size_) return true;
  // Allocate the memory now: a page that is missing later would end the process.
  const auto more = static_cast<off_t>(bytes - size_);
  while (::fallocate(file_.get(), 0, static_cast<off_t>(size_), more) != 0)
    if (errno != EINTR) return false;
  size_ = bytes;
  return true;
}

std::span<std::byte> SharedMemory::map(std::size_t bytes) {
  if (bytes > mapped_) {
    unmap();
    void* const at = ::mmap(nullptr, bytes, writable_ ? PROT_READ | PROT_WRITE : PROT_READ, MAP_SHARED, file_.get(), 0);
    if (at == MAP_FAILED) return {};
    at_ = at;
    mapped_ = bytes;
  }
  return {static_cast<std::byte*>(at_), bytes};
}

void SharedMemory::unmap() {
  if (at_) (void)::munmap(at_, mapped_);
  at_ = nullptr;
  mapped_ = 0;
}

DecodeRequest request_of(DecodeOperation operation, std::size_t bytes, const render::ImageLimits& limits) {
  return {operation, bytes, limits.file_pixels, limits.kept_pixels, limits.working_bytes};
}

std::string error_in(const DecodeAnswer& answer) {
  const char* const end = std::find(std::begin(answer.text), std::end(answer.text), '\0');
  std::string text(std::begin(answer.text), end);
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
  return text.empty() ? "the decoder gave no result and no reason" : text;
}

std::variant<render::Image, render::ImageError> check_answer(const DecodeAnswer& answer, const DecodeRequest& request) {
  if (answer.width == 0) return render::ImageError{error_in(answer)};
  const std::uint64_t pixels = std::uint64_t{answer.width} * answer.height;
  const bool good = answer.height > 0 && answer.components >= 1 && answer.components <= 4 && answer.reduction >= 1 &&
                    answer.slices >= 1 && answer.height % answer.slices == 0 &&
                    (answer.cube == 0 || answer.slices == 6) &&
                    pixels <= std::max<std::uint64_t>(request.kept_pixels, 1);
  if (!good) return render::ImageError{"the decoder gave an impossible image"};
  render::Image image;
  image.width = answer.width;
  image.height = answer.height;
  image.components = answer.components;
  image.reduction = answer.reduction;
  image.slices = answer.slices;
  image.cube = answer.cube != 0;
  return image;
}

}  // namespace gs::app
