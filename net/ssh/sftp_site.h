#pragma once

#include "net/serve/served_folder.h"
#include "net/ssh/sftp_client.h"
#include "net/tunnel/multiplexer.h"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gs::net {

/// HTTP server for this process with the files of an SFTP server: GET and HEAD, ranges, validators, folders as JSON.
/// Its clients are as trusted as this process. It makes no files. One thread.
class SftpSite final : public Multiplexer {
 public:
  explicit SftpSite(Time now);
  ~SftpSite() override;

  [[nodiscard]] std::optional<std::string> receive(std::span<const std::byte> bytes, Time now) override;
  [[nodiscard]] std::span<const std::byte> outgoing() const override { return sftp_.outgoing(); }
  void sent(std::size_t bytes) override { sftp_.sent(bytes); }
  [[nodiscard]] std::optional<std::string> step(Time now) override;
  [[nodiscard]] std::optional<Time> deadline() const override;
  [[nodiscard]] ConnectionId open() override;
  [[nodiscard]] std::size_t room(ConnectionId id) const override;
  void send(ConnectionId id, std::span<const std::byte> bytes) override;
  [[nodiscard]] std::span<const std::byte> received(ConnectionId id) const override;
  void took(ConnectionId id, std::size_t bytes) override;
  [[nodiscard]] bool ended(ConnectionId id) const override;
  void close(ConnectionId id) override;

  [[nodiscard]] bool ready() const { return sftp_.ready(); }

 private:
  struct Connection;
  using Next = std::function<void(Connection& connection, const SftpAnswer& answer)>;

  [[nodiscard]] SftpClient::Take for_connection(ConnectionId id, Next next);
  [[nodiscard]] Connection* find(ConnectionId id) const;
  void begin_request(Connection& connection);
  void check_limit(Connection& connection, const RequestPath& limit);
  void look(Connection& connection);
  void take_attributes(Connection& connection, const SftpAnswer& answer);
  void open_file(Connection& connection);
  void list(Connection& connection, const std::string& handle);
  void answer_file(Connection& connection, const SftpAttributes& attributes);
  void answer_text(Connection& connection, int status, const std::string& mime, const std::string& body,
                   const std::string& more = {});
  void refuse(Connection& connection, const SftpAnswer& answer);
  void end_request(Connection& connection);
  void read_on(Connection& connection);
  void read_block(Connection& connection, std::uint64_t offset, std::uint32_t bytes);
  void take_block(Connection& connection, std::uint64_t offset, std::uint32_t bytes, const SftpAnswer& answer);

  SftpClient sftp_;
  std::map<ConnectionId, std::unique_ptr<Connection>> connections_;
  ConnectionId last_id_ = 0;
  Time heard_;  // time of the last received bytes, or of the last step without pending requests
};

}  // namespace gs::net
