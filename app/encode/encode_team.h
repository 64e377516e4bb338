#pragma once

#include "base/json_value.h"
#include "qnv/codecs/shared/ranks.h"
#include "qnv/codecs/shared/stream_sink.h"

#include <memory>
#include <optional>
#include <string>

namespace gs::app {

/// File that the processes of a team write together. Each one writes some bytes and skips the others.
class TeamFile : public qnv::StreamSink {
 public:
  /// Waits until all processes have written their bytes. All of them call it once. Returns a message on failure.
  [[nodiscard]] virtual std::optional<std::string> finish() = 0;
};

/// Processes that run one `encode` command together, as this process sees them.
class EncodeTeam {
 public:
  virtual ~EncodeTeam() = default;

  [[nodiscard]] virtual qnv::Ranks& ranks() = 0;
  /// Returns the number of threads that suit this process, beside the others on its machine.
  [[nodiscard]] virtual unsigned threads() const = 0;
  /// Returns a text that identifies the task, apart from the contents of its files.
  [[nodiscard]] virtual std::string task() const = 0;
  /// Returns the errors that this process has printed. Only rank 0 shows its own, and returns an empty text.
  [[nodiscard]] virtual std::string hidden_errors() const = 0;
  /// Creates the output. All processes call it. Returns null if a process cannot write it.
  [[nodiscard]] virtual std::unique_ptr<TeamFile> create(const std::string& path) = 0;
  /// Returns the messages, bytes, memory and computing time of each process. All of them call it.
  [[nodiscard]] virtual JsonValue statistics() = 0;
  /// Notes that all processes end the command now. Otherwise the end of one process ends the others.
  virtual void end_together() = 0;
};

/// Sets the team of this process, which must outlive all commands. Null means this process alone.
void set_encode_team(EncodeTeam* team);
[[nodiscard]] EncodeTeam* encode_team();

}  // namespace gs::app
