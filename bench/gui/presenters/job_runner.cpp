// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/job_runner.h"

#include <utility>

namespace todbench {

JobRunner::JobRunner(QObject* parent) : QObject(parent), thread_(QThread::create([this] { run(end_.get_token()); })) {
  thread_->start();
}

JobRunner::~JobRunner() {
  shut_down();
}

void JobRunner::shut_down() {
  end_.request_stop();
  (void)stop();
  wake_.notify_all();
  thread_->wait();
}

void JobRunner::start(Job job) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    waiting_.push_back(std::move(job));
    if (running_) running_->request_stop();
  }
  wake_.notify_all();
}

void JobRunner::queue(Job job) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(job));
  }
  wake_.notify_all();
}

JobRunner::Waiting JobRunner::stop() {
  const std::lock_guard lock(mutex_);
  const Waiting waiting = waiting_.empty() ? Waiting::none : Waiting::dropped;
  waiting_.clear();
  if (running_) running_->request_stop();
  return waiting;
}

bool JobRunner::busy() const {
  const std::lock_guard lock(mutex_);
  return !waiting_.empty() || running_;
}

void JobRunner::run(const std::stop_token& end) {
  for (;;) {
    Job job;
    std::stop_token stop;
    {
      std::unique_lock lock(mutex_);
      if (!wake_.wait(lock, end, [this] { return !waiting_.empty(); })) return;
      job = std::move(waiting_.front());
      waiting_.pop_front();
      running_.emplace();
      stop = running_->get_token();
    }
    job(stop);
    const std::lock_guard lock(mutex_);
    running_.reset();
  }
}

}  // namespace todbench
