#include "app/worker.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <thread>

namespace {

using gs::app::Worker;

void finish(Worker& worker) {
  while (!worker.poll()) std::this_thread::yield();
}

}  // namespace

TEST_CASE("A job runs elsewhere and is delivered here") {
  std::atomic<int> wakes = 0;
  Worker worker([&] { ++wakes; });
  const std::thread::id here = std::this_thread::get_id();
  std::thread::id job_thread, delivery_thread;
  int result = 0;
  CHECK_FALSE(worker.poll());
  worker.start(
      [&]() -> Worker::Delivery {
        job_thread = std::this_thread::get_id();
        auto made = std::make_shared<int>(42);
        return [&, made] {
          delivery_thread = std::this_thread::get_id();
          result = *made;
        };
      },
      {});
  CHECK(worker.busy());
  finish(worker);
  CHECK_FALSE(worker.busy());
  CHECK(wakes == 1);
  CHECK(result == 42);
  CHECK(job_thread != here);
  CHECK(delivery_thread == here);
}

TEST_CASE("A delivery may start the next job, and a job that throws is told as failed") {
  Worker worker;
  bool failed = false;
  worker.start(
      [&]() -> Worker::Delivery {
        return [&] {
          worker.start([]() -> Worker::Delivery { throw std::runtime_error("broken"); }, [&] { failed = true; });
        };
      },
      {});
  finish(worker);
  CHECK(worker.busy());
  finish(worker);
  CHECK(failed);
}

TEST_CASE("Ending while a job runs waits for it and delivers nothing") {
  std::atomic<bool> ran = false;
  bool delivered = false;
  {
    Worker worker;
    worker.start(
        [&]() -> Worker::Delivery {
          ran = true;
          return [&] { delivered = true; };
        },
        {});
  }
  CHECK(ran);
  CHECK_FALSE(delivered);
}
