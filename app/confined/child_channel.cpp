#include "app/confined/child_channel.h"

#include "app/base/exit_status.h"
#include "app/base/local_file.h"

#include <cstring>
#include <utility>
#include <vector>

#include <unistd.h>

namespace gs::app {

bool receive_request(DecodeRequest& request) {
  return read_bytes(kDecoderSocket, std::as_writable_bytes(std::span(&request, 1)));
}

bool send_answer(const DecodeAnswer& answer) {
  return write_bytes(kDecoderSocket, std::as_bytes(std::span(&answer, 1)));
}

void set_error(DecodeAnswer& answer, const std::string& message) {
  message.copy(answer.text, DecodeAnswer::kTextBytes - 1);
}

bool send_results(SharedMemory& result, std::span<const std::byte> bytes) {
  std::byte sign{};
  if (!read_bytes(kDecoderSocket, {&sign, 1})) return false;
  if (!bytes.empty()) {
    const std::span<std::byte> to = result.map(bytes.size());
    if (to.size() != bytes.size()) return false;
    std::memcpy(to.data(), bytes.data(), bytes.size());
  }
  return write_bytes(kDecoderSocket, {&sign, 1});
}

BytesResult ask_parent_for_file(SharedMemory& result, const std::string& reference) {
  DecodeAnswer answer;
  answer.good = DecodeAnswer::kAsksForFile;
  if (reference.size() >= DecodeAnswer::kTextBytes) return std::string("its name is too long");
  set_error(answer, reference);
  DecodeRequest reply;
  if (!send_answer(answer) || !receive_request(reply)) ::_exit(kFailed);
  if (reply.operation != DecodeOperation::give_file) ::_exit(kFailed);
  if (reply.count == DecodeRequest::kGivenDescriptor) {
    auto file = net::map_descriptor(receive_descriptor(kDecoderSocket));
    if (!file) return std::string("it cannot be mapped");
    return shared_bytes(std::move(*file));
  }
  const auto found = reply.bytes > 0 ? result.map(static_cast<std::size_t>(reply.bytes)) : std::span<std::byte>();
  if (found.size() != reply.bytes) ::_exit(kFailed);
  if (reply.count == DecodeRequest::kGivenBytes)
    return shared_bytes(std::vector<std::byte>(found.begin(), found.end()));
  return std::string(reinterpret_cast<const char*>(found.data()), found.size());
}

}  // namespace gs::app
