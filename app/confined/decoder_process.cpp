#include "app/confined/decoder_process.h"

#include "app/base/child_process.h"
#include "net/files/file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gs::app {

DecoderProcess::DecoderProcess(const std::string& program, DecoderKind kind, int file, std::uint64_t memory) {
  start(program, kind, file, memory);
}

DecoderProcess::~DecoderProcess() { (void)end(); }

void DecoderProcess::start(const std::string& program, DecoderKind kind, int file, std::uint64_t memory) {
  auto input = SharedMemory::create(), result = SharedMemory::create();
  int ends[2] = {-1, -1};
  if (!input || !result || ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return;
  net::Descriptor own(ends[0]);
  const net::Descriptor others(ends[1]);
  const std::array<int, 3> given = {others.get(), file >= 0 ? file : input->file(), result->file()};
  const std::string mebibytes = std::to_string(memory >> 20);
  child_ = start_child(program, {std::string(kDecoderArgument), std::string(name_of(kind)), mebibytes}, given);
  socket_ = std::move(own);
  input_ = std::move(*input);
  result_ = std::move(*result);
}

bool DecoderProcess::load(std::span<const std::byte> bytes, std::span<const std::byte> more) {
  const std::size_t all = bytes.size() + more.size();
  if (bytes.empty() || !input_.grow(all)) return false;
  const std::span<std::byte> to = input_.map(input_.size());
  if (to.size() < all) return false;
  std::ranges::copy(bytes, to.begin());
  std::ranges::copy(more, to.begin() + static_cast<std::ptrdiff_t>(bytes.size()));
  return true;
}

bool DecoderProcess::put_result(std::span<const std::byte> bytes) {
  if (bytes.empty()) return true;
  if (!result_.grow(bytes.size())) return false;
  const std::span<std::byte> to = result_.map(result_.size());
  if (to.size() < bytes.size()) return false;
  std::ranges::copy(bytes, to.begin());
  return true;
}

std::optional<render::ImageError> DecoderProcess::await_results(std::size_t bytes, const Stopped& stopped,
                                                                Clock::time_point end) {
  if (!result_.grow(bytes)) {
    (void)this->end();  // it waits for the memory
    return render::ImageError{"no memory for the result"};
  }
  std::byte sign{1};
  if (!send({&sign, 1})) return failure(Wait::ended);
  if (const Wait wait = receive({&sign, 1}, stopped, end); wait != Wait::answered) return failure(wait);
  return std::nullopt;
}

std::variant<std::vector<std::byte>, render::ImageError> DecoderProcess::take_bytes(const DecodeAnswer& answer,
                                                                                    const Stopped& stopped,
                                                                                    std::chrono::milliseconds patience,
                                                                                    std::uint64_t most) {
  if (answer.good != 1) return render::ImageError{error_in(answer)};
  if (answer.count > most) {
    (void)end();
    return render::ImageError{"its result exceeds the memory of a world"};
  }
  const auto size = static_cast<std::size_t>(answer.count);
  if (auto error = await_results(size, stopped, Clock::now() + patience)) return std::move(*error);
  const std::span<const std::byte> bytes = results(size);
  if (bytes.size() < size) return render::ImageError{"no memory for the result"};
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

std::variant<DecodeAnswer, render::ImageError> DecoderProcess::ask(const DecodeRequest& request, const Stopped& stopped,
                                                                   std::chrono::milliseconds patience,
                                                                   std::size_t result_bytes) {
  if (!good()) return render::ImageError{"the process for decoding cannot be started"};
  if (!result_.grow(result_bytes)) return render::ImageError{"no memory for the result"};
  if (!send(std::as_bytes(std::span(&request, 1)))) return failure(Wait::ended);
  return await_answer(stopped, patience);
}

bool DecoderProcess::begin(const DecodeRequest& request, std::size_t result_bytes) {
  if (!good() || !result_.grow(result_bytes)) return false;
  if (send(std::as_bytes(std::span(&request, 1)))) return true;
  (void)failure(Wait::ended);
  return false;
}

bool DecoderProcess::has_answer() const {
  pollfd ready{socket_.get(), POLLIN, 0};
  return ::poll(&ready, 1, 0) > 0;
}

std::variant<DecodeAnswer, render::ImageError> DecoderProcess::give_file(const BytesResult& file,
                                                                         const Stopped& stopped,
                                                                         std::chrono::milliseconds patience) {
  DecodeRequest reply = request_of(DecodeOperation::give_file, 0);
  const auto* const found = std::get_if<SharedBytes>(&file);
  const bool whole = found && found->file && found->file->bytes().size() == found->bytes.size();
  if (const int descriptor = whole ? found->file->descriptor() : -1; descriptor >= 0) {
    reply.count = DecodeRequest::kGivenDescriptor;
    if (!send(std::as_bytes(std::span(&reply, 1))) || !send_descriptor(socket_.get(), descriptor))
      return failure(Wait::ended);
    return await_answer(stopped, patience);
  }
  const std::string* const error = std::get_if<std::string>(&file);
  const auto bytes = found ? found->bytes : std::as_bytes(std::span(error->data(), error->size()));
  reply.count = found ? DecodeRequest::kGivenBytes : DecodeRequest::kGivenError;
  reply.bytes = bytes.size();
  if (!put_result(bytes)) return render::ImageError{"no memory for a file that it refers to"};
  return ask(reply, stopped, patience);
}

std::variant<DecodeAnswer, render::ImageError> DecoderProcess::await_answer(const Stopped& stopped,
                                                                            std::chrono::milliseconds patience) {
  if (!good()) return render::ImageError{"the process for decoding cannot be started"};
  DecodeAnswer answer;
  const Wait wait = receive(std::as_writable_bytes(std::span(&answer, 1)), stopped, Clock::now() + patience);
  if (wait != Wait::answered) return failure(wait);
  return answer;
}

std::variant<render::Image, render::ImageError> DecoderProcess::ask_image(const DecodeRequest& request,
                                                                          const Stopped& stopped,
                                                                          std::chrono::milliseconds patience,
                                                                          DecodeAnswer& answer) {
  const Clock::time_point end = Clock::now() + patience;
  auto answered = ask(request, stopped, patience);
  if (auto* const error = std::get_if<render::ImageError>(&answered)) return std::move(*error);
  answer = std::get<DecodeAnswer>(answered);
  auto checked = check_answer(answer, request);
  auto* const image = std::get_if<render::Image>(&checked);
  if (!image) {
    if (answer.width != 0) (void)this->end();  // it waits for memory
    return checked;
  }
  const std::size_t pixel_bytes = std::size_t{image->width} * image->height * image->components;
  if (auto error = await_results(pixel_bytes, stopped, end)) return std::move(*error);
  const std::span<const std::byte> pixels = results(pixel_bytes);
  if (pixels.size() < pixel_bytes) return render::ImageError{"no memory for its pixels"};
  const auto* const first = reinterpret_cast<const std::uint8_t*>(pixels.data());
  image->pixels.assign(first, first + pixel_bytes);
  return checked;
}

std::variant<render::Image, render::ImageError> DecoderProcess::decode(std::span<const std::byte> bytes,
                                                                       const render::ImageLimits& limits,
                                                                       std::chrono::milliseconds patience) {
  if (!good()) return render::ImageError{"the process for decoding cannot be started"};
  if (!load(bytes)) return render::ImageError{"no memory to decode it"};
  DecodeAnswer answer;
  return ask_image(request_of(DecodeOperation::picture, bytes.size(), limits), limits.stopped, patience, answer);
}

std::span<const std::byte> DecoderProcess::results(std::size_t bytes) {
  if (bytes == 0 || bytes > result_.size()) return {};
  const std::span<const std::byte> all = result_.map(result_.size());
  return all.size() < bytes ? std::span<const std::byte>() : all.first(bytes);
}

bool DecoderProcess::send(std::span<const std::byte> bytes) const {
  // Requests are shorter than the buffer of a socket, so this never waits.
  return ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
}

DecoderProcess::Wait DecoderProcess::receive(std::span<std::byte> bytes, const Stopped& stopped,
                                             Clock::time_point end) {
  while (!bytes.empty()) {
    pollfd ready{socket_.get(), POLLIN, 0};
    const int found = ::poll(&ready, 1, 20);
    if (found < 0 && errno != EINTR) return Wait::ended;
    if (found <= 0) {
      if (stopped && stopped()) return Wait::stopped;
      if (Clock::now() >= end) return Wait::late;
      continue;
    }
    const ssize_t count = ::read(socket_.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return Wait::ended;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return Wait::answered;
}

render::ImageError DecoderProcess::failure(Wait wait) {
  const std::string reason = end();
  if (wait == Wait::stopped) return {"decoding was stopped"};
  if (wait == Wait::late) return {"decoding takes too long"};
  return {"the process that decoded it ended" + (reason.empty() ? "" : " by " + reason)};
}

bool DecoderProcess::runs() {
  int status = 0;
  if (child_ > 0 && ::waitpid(child_, &status, WNOHANG) != 0) child_ = 0;
  return good();
}

std::string DecoderProcess::end() {
  const pid_t child = std::exchange(child_, 0);
  if (child <= 0) return {};
  socket_ = {};
  int status = 0;
  // A child that closed its socket ends at once. Give it the time, for the reason.
  for (int i = 0; i < 50; ++i) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return WIFSIGNALED(status) ? std::string("signal ") + ::strsignal(WTERMSIG(status)) : "";
    if (ended < 0 && errno != EINTR) return {};
    if (i == 2) (void)::kill(child, SIGKILL);
    (void)::poll(nullptr, 0, 1);
  }
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return {};
}

}  // namespace gs::app
