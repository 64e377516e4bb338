// The C functions of ghostspace/insitu.h. No exception leaves them.
#include "app/insitu/insitu_session.h"

#include <algorithm>
#include <cstring>
#include <exception>

struct gs_insitu {
  std::unique_ptr<gs::app::insitu::InSituSession> session;
};

namespace {

using gs::app::insitu::InSituSession;

// Calls a function of a session. Turns exceptions into results.
template <class Work>
int guarded(gs_insitu* handle, const void* argument, const Work& work) {
  if (!handle) return GS_INSITU_INVALID;
  if (!argument) return handle->session->fail(GS_INSITU_INVALID, "an argument is NULL; expected an address");
  try {
    return work(*handle->session);
  } catch (const std::exception& problem) {
    try {
      return handle->session->fail(GS_INSITU_FAILED, problem.what());
    } catch (const std::exception&) {
      return GS_INSITU_FAILED;
    }
  }
}

void copy_message(std::string_view message, char* to, std::size_t size) {
  if (!to || size == 0) return;
  const std::size_t count = std::min(message.size(), size - 1);
  std::memcpy(to, message.data(), count);
  to[count] = 0;
}

}  // namespace

uint32_t gs_insitu_version(void) { return GS_INSITU_VERSION; }

void gs_insitu_options_init(gs_insitu_options* options, size_t size) {
  if (!options || size == 0) return;
  gs_insitu_options defaults{};
  defaults.size = size;
  defaults.relative_error = 0.001;
  defaults.every = 1;
  defaults.max_share = GS_INSITU_USUAL_SHARE;
  defaults.max_memory = std::uint64_t{256} << 20;
  defaults.threads = 1;
  std::memset(options, 0, size);
  std::memcpy(options, &defaults, std::min(size, sizeof defaults));
}

gs_insitu* gs_insitu_open(const gs_insitu_options* options, const gs_insitu_communicator* communicator, char* error,
                          size_t error_size) {
  copy_message("", error, error_size);
  try {
    if (!options) {
      copy_message("the options are NULL; expected their address", error, error_size);
      return nullptr;
    }
    if (const char* problem = communicator ? gs::app::insitu::check_communicator(*communicator) : nullptr) {
      copy_message(problem, error, error_size);
      return nullptr;
    }
    const auto read = gs::app::insitu::session_options(*options);
    if (const auto* problem = std::get_if<std::string>(&read)) {
      copy_message(*problem, error, error_size);
      return nullptr;
    }
    auto opened = InSituSession::open(std::get<gs::app::insitu::SessionOptions>(read), communicator);
    if (const auto* problem = std::get_if<std::string>(&opened)) {
      copy_message(*problem, error, error_size);
      return nullptr;
    }
    return new gs_insitu{std::move(std::get<std::unique_ptr<InSituSession>>(opened))};
  } catch (const std::exception& problem) {
    copy_message(problem.what(), error, error_size);
    return nullptr;
  }
}

int gs_insitu_add_parameter(gs_insitu* session, const gs_insitu_parameter* parameter) {
  return guarded(session, parameter, [&](InSituSession& own) {
    if (parameter->size < sizeof *parameter)
      return own.fail(GS_INSITU_INVALID, "the size of a parameter is wrong; set `size` to sizeof");
    return own.add_parameter(*parameter);
  });
}

double gs_insitu_value(const gs_insitu* session, const char* name) {
  if (!session) return std::numeric_limits<double>::quiet_NaN();
  return session->session->value(name);
}

int gs_insitu_begin_step(gs_insitu* session, int64_t step, double time) {
  return guarded(session, session, [&](InSituSession& own) { return own.begin_step(step, time); });
}

int gs_insitu_pass_block(gs_insitu* session, const gs_insitu_block* block) {
  return guarded(session, block, [&](InSituSession& own) { return own.pass_block(*block); });
}

int gs_insitu_pass_cells(gs_insitu* session, const gs_insitu_cells* cells) {
  return guarded(session, cells, [&](InSituSession& own) { return own.pass_cells(*cells); });
}

int gs_insitu_pass_particles(gs_insitu* session, const gs_insitu_particles* particles) {
  return guarded(session, particles, [&](InSituSession& own) { return own.pass_particles(*particles); });
}

int gs_insitu_end_step(gs_insitu* session) {
  return guarded(session, session, [](InSituSession& own) { return own.end_step(); });
}

int gs_insitu_port(const gs_insitu* session) { return session ? session->session->port() : 0; }

const char* gs_insitu_error(const gs_insitu* session) {
  return session ? session->session->error().c_str() : "the session is NULL";
}

int gs_insitu_get_statistics(const gs_insitu* session, gs_insitu_statistics* statistics) {
  if (!session || !statistics || statistics->size < sizeof(size_t)) return GS_INSITU_INVALID;
  gs_insitu_statistics all = session->session->statistics();
  all.size = std::min(statistics->size, sizeof all);
  std::memcpy(statistics, &all, all.size);
  return GS_INSITU_OK;
}

int gs_insitu_flush(gs_insitu* session) {
  return guarded(session, session, [](InSituSession& own) { return own.flush(); });
}

void gs_insitu_close(gs_insitu* session) { delete session; }
