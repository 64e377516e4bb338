#include "net/ssh/sftp_client.h"

#include "net/base/network_bytes.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace gs::net {
namespace {

constexpr std::uint32_t kSftpVersion = 3;
constexpr std::size_t kMaxPacket = std::size_t{256} << 10;
/// Packet types (3).
enum SftpPacket : std::uint8_t {
  kInit = 1,
  kVersionPacket = 2,
  kOpen = 3,
  kClose = 4,
  kRead = 5,
  kStatus = 101,
  kHandle = 102,
  kData = 103,
  kName = 104,
  kAttributes = 105
};

void put_text(NetworkWriter& writer, std::string_view text) {
  writer.integer(static_cast<std::uint32_t>(text.size()));
  writer.bytes(std::as_bytes(std::span(text)));
}

std::span<const std::byte> get_bytes(NetworkReader& reader) { return reader.bytes(reader.integer<std::uint32_t>()); }

std::string get_text(NetworkReader& reader) {
  const auto bytes = get_bytes(reader);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

SftpAttributes get_attributes(NetworkReader& reader) {
  SftpAttributes result;
  const auto flags = reader.integer<std::uint32_t>();
  if ((flags & 1U) != 0) result.size = reader.integer<std::uint64_t>();
  if ((flags & 2U) != 0) (void)reader.bytes(8);  // numbers of user and group
  if ((flags & 4U) != 0) result.mode = reader.integer<std::uint32_t>();
  if ((flags & 8U) != 0) {
    (void)reader.integer<std::uint32_t>();  // time of the last access
    result.modified = reader.integer<std::uint32_t>();
  }
  if ((flags & 0x80000000U) == 0) return result;
  for (auto left = reader.integer<std::uint32_t>(); left > 0 && reader.good(); --left) {
    (void)get_bytes(reader);
    (void)get_bytes(reader);
  }
  return result;
}

// Reads an answer after its id. Returns nullopt if it is malformed.
std::optional<SftpAnswer> parse_answer(std::uint8_t type, NetworkReader& reader) {
  SftpAnswer answer;
  switch (type) {
    case kStatus:
      answer.kind = SftpAnswer::Kind::status;
      answer.status = reader.integer<std::uint32_t>();
      if (!reader.good()) return std::nullopt;
      // Old servers send no message.
      if (!reader.rest().empty()) answer.text = get_text(reader);
      return answer;
    case kHandle:
      answer.kind = SftpAnswer::Kind::handle;
      answer.text = get_text(reader);
      if (answer.text.size() > 256) return std::nullopt;
      break;
    case kData:
      answer.kind = SftpAnswer::Kind::data;
      answer.data = get_bytes(reader);
      break;
    case kName:
      answer.kind = SftpAnswer::Kind::names;
      for (auto left = reader.integer<std::uint32_t>(); left > 0 && reader.good(); --left) {
        SftpName one;
        one.name = get_text(reader);
        (void)get_bytes(reader);  // a line as of 'ls -l'
        one.attributes = get_attributes(reader);
        if (reader.good()) answer.names.push_back(std::move(one));
      }
      break;
    case kAttributes:
      answer.kind = SftpAnswer::Kind::attributes;
      answer.attributes = get_attributes(reader);
      break;
    default:
      return std::nullopt;
  }
  return reader.good() ? std::optional(std::move(answer)) : std::nullopt;
}

}  // namespace

SftpClient::SftpClient() {
  NetworkWriter writer(out_);
  writer.integer(std::uint32_t{5});
  writer.integer(static_cast<std::uint8_t>(kInit));
  writer.integer(kSftpVersion);
}

void SftpClient::sent(std::size_t bytes) {
  out_begin_ += bytes;
  if (out_begin_ < out_.size() / 2) return;
  out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(out_begin_));
  out_begin_ = 0;
}

std::optional<std::string> SftpClient::receive(std::span<const std::byte> bytes) {
  in_.insert(in_.end(), bytes.begin(), bytes.end());
  std::size_t begin = 0;
  std::optional<std::string> problem;
  while (!problem && in_.size() - begin >= 4) {
    const auto rest = std::span(std::as_const(in_)).subspan(begin);
    const auto size = NetworkReader(rest).integer<std::uint32_t>();
    if (size == 0 || size > kMaxPacket)
      return ready_ ? "its SFTP server sends a packet of " + std::to_string(size) + " bytes"
                    : std::string("it prints text at login, which SFTP does not allow");
    if (rest.size() - 4 < size) break;
    problem = take(rest.subspan(4, size));
    begin += 4 + size;
  }
  in_.erase(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(begin));
  return problem;
}

std::optional<std::string> SftpClient::take(std::span<const std::byte> packet) {
  NetworkReader reader(packet);
  const auto type = reader.integer<std::uint8_t>();
  const auto id = reader.integer<std::uint32_t>();
  if (!ready_) {
    if (type != kVersionPacket || !reader.good()) return "its SFTP server does not begin with its version";
    if (id < kSftpVersion) return "its SFTP server has version " + std::to_string(id) + "; expected 3";
    ready_ = true;
    return std::nullopt;
  }
  const auto found = pending_.find(id);
  if (!reader.good() || found == pending_.end()) return "its SFTP server answers a request that was not made";
  const auto answer = parse_answer(type, reader);
  if (!answer) return "its SFTP server sends a malformed answer";
  // The receiver may make requests.
  const Take taker = std::move(found->second);
  pending_.erase(found);
  if (taker) taker(*answer);
  return std::nullopt;
}

void SftpClient::ask(std::uint8_t type, const std::vector<std::byte>& body, Take take) {
  const std::uint32_t id = ++last_id_;
  NetworkWriter writer(out_);
  writer.integer(static_cast<std::uint32_t>(5 + body.size()));
  writer.integer(type);
  writer.integer(id);
  writer.bytes(body);
  pending_[id] = std::move(take);
}

void SftpClient::ask_name(std::uint8_t type, const std::string& name, Take take) {
  std::vector<std::byte> body;
  NetworkWriter writer(body);
  put_text(writer, name);
  ask(type, body, std::move(take));
}

void SftpClient::open(const std::string& path, Take take) {
  std::vector<std::byte> body;
  NetworkWriter writer(body);
  put_text(writer, path);
  writer.integer(std::uint32_t{1});  // for reading
  writer.integer(std::uint32_t{0});  // no attributes
  ask(kOpen, body, std::move(take));
}

void SftpClient::read(const std::string& handle, std::uint64_t offset, std::uint32_t bytes, Take take) {
  std::vector<std::byte> body;
  NetworkWriter writer(body);
  put_text(writer, handle);
  writer.integer(offset);
  writer.integer(bytes);
  ask(kRead, body, std::move(take));
}

void SftpClient::close(const std::string& handle) { ask_name(kClose, handle, {}); }

}  // namespace gs::net
