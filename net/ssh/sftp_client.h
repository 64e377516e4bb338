#pragma once

#include "base/noncopyable.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::net {

/// Attributes of a remote file (draft-ietf-secsh-filexfer-02, 5).
struct SftpAttributes {
  std::optional<std::uint64_t> size;
  std::optional<std::uint32_t> mode, modified;  // type and permissions; Unix seconds

  [[nodiscard]] bool is_folder() const { return mode && (*mode & 0170000U) == 0040000U; }
  [[nodiscard]] bool is_file() const { return !mode || (*mode & 0170000U) == 0100000U; }
};

struct SftpName {
  std::string name;
  SftpAttributes attributes;
};

/// Answer to one request. Exactly the members of its kind are set.
struct SftpAnswer {
  enum class Kind : std::uint8_t { status, handle, data, names, attributes };
  Kind kind = Kind::status;
  std::uint32_t status = 0;
  std::string text;                 // the message of a status, or a handle
  std::span<const std::byte> data;  // valid during the call
  std::vector<SftpName> names;
  SftpAttributes attributes;
};

// Values of SftpAnswer::status.
inline constexpr std::uint32_t kSftpEnd = 1, kSftpNoFile = 2, kSftpNotPermitted = 3;
/// Maximum bytes of one read.
inline constexpr std::uint32_t kSftpRead = 32768;

/// Client of SFTP version 3, reading only, as a state machine without descriptors. Requests are answered in any order.
/// One thread.
class SftpClient : NonCopyable {
 public:
  using Take = std::function<void(const SftpAnswer& answer)>;

  SftpClient();
  /// Takes bytes of the server, and calls the receivers of the answers. Returns the error after which the connection is
  /// useless.
  [[nodiscard]] std::optional<std::string> receive(std::span<const std::byte> bytes);
  [[nodiscard]] std::span<const std::byte> outgoing() const { return std::span(out_).subspan(out_begin_); }
  void sent(std::size_t bytes);
  /// Reports whether the server has answered with its version.
  [[nodiscard]] bool ready() const { return ready_; }
  /// Returns the number of requests without an answer.
  [[nodiscard]] std::size_t pending() const { return pending_.size(); }

  void stat(const std::string& path, Take take) { ask_name(17, path, std::move(take)); }
  void real_path(const std::string& path, Take take) { ask_name(16, path, std::move(take)); }
  void open(const std::string& path, Take take);
  void stat_handle(const std::string& handle, Take take) { ask_name(8, handle, std::move(take)); }
  void read(const std::string& handle, std::uint64_t offset, std::uint32_t bytes, Take take);
  void close(const std::string& handle);
  void open_folder(const std::string& path, Take take) { ask_name(11, path, std::move(take)); }
  void read_folder(const std::string& handle, Take take) { ask_name(12, handle, std::move(take)); }

 private:
  void ask(std::uint8_t type, const std::vector<std::byte>& body, Take take);
  void ask_name(std::uint8_t type, const std::string& name, Take take);
  [[nodiscard]] std::optional<std::string> take(std::span<const std::byte> packet);

  std::vector<std::byte> in_, out_;
  std::size_t out_begin_ = 0;
  bool ready_ = false;
  std::uint32_t last_id_ = 0;
  std::map<std::uint32_t, Take> pending_;
};

}  // namespace gs::net
