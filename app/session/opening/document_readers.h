#pragma once

#include "app/session/documents/session_log.h"
#include "app/session/documents/world_reader.h"
#include "app/session/opening/link_follower.h"
#include "app/session/opening/series_playback.h"
#include "app/session/opening/session_questions.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace gs::render {
class MeshWorker;
}

namespace gs::app {

/// Parts of a session that learn about the files that it reads.
struct ReaderPeers {
  SessionLog& log;
  SessionQuestions& questions;
  SeriesList& series;
  LinkFollower& links;
};

/// Reader threads of the files that viewports want, and their results. One thread.
class DocumentReaders {
 public:
  /// Creates no thread yet. `wake` is called on the reader threads when there is news. `meshes` makes the meshes of
  /// changed geometry; null makes them at once.
  DocumentReaders(StepContext& step, SessionViewports& viewports, const LoadOptions& load, ReaderPeers peers,
                  std::function<void()> wake, std::shared_ptr<render::MeshWorker> meshes);
  /// Cancels all readings, and waits for the threads.
  ~DocumentReaders();
  DocumentReaders(const DocumentReaders&) = delete;
  DocumentReaders& operator=(const DocumentReaders&) = delete;

  /// Starts readers for files that viewports want.
  void begin();
  /// Applies the news of all readers. Returns true if the picture or the progress changed.
  bool take_news();
  /// Takes the finished meshes of all worlds, so that none wait for a view. Returns true if the picture changed.
  bool take_meshes();
  /// Shows a running world that was opened elsewhere in the active viewport.
  void show(std::shared_ptr<Document> document);
  /// Stops loading the file of a visible viewport. `place` is its index in `Panes::visible`.
  void cancel(std::size_t place);

  /// Returns true if the file of a visible viewport is loading.
  [[nodiscard]] bool loading() const;
  /// Returns the progress of the readings of a file.
  [[nodiscard]] std::vector<LoadingState> progress_of(const std::string& path) const;
  /// Files and streams of a world that is open or being read.
  struct Loads {
    std::string path;                    // of the world
    std::shared_ptr<Document> document;  // null while it is being read
    std::shared_ptr<LoadLedger> ledger;
  };
  /// Returns the loads of all worlds, including those that failed last.
  [[nodiscard]] std::vector<Loads> loads() const;

 private:
  /// File that is being read.
  struct Reader {
    DocumentList::Reading reading;
    std::shared_ptr<WorldReader> reader;
    LoadingState state;
  };

  bool take_document(const Reader& from, WorldReader::News& news);
  bool apply_updates(Document& document, const std::string& path, WorldReader::News news);
  void note_empty(const Document& document, const std::string& path);
  void show_failed(std::uint64_t reading, const std::string& path, const Diagnostics& diagnostics);

  StepContext& step_;
  SessionViewports& viewports_;
  const LoadOptions& load_;
  ReaderPeers peers_;
  std::function<void()> wake_;
  std::shared_ptr<render::MeshWorker> meshes_;  // null in simulated time
  std::vector<Reader> readers_;
  std::vector<std::shared_ptr<WorldReader>> retired_;  // no longer needed; they end as soon as they can
  std::vector<Loads> failed_loads_;
};

}  // namespace gs::app
