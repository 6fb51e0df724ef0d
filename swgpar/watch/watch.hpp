// Signals and a sign of life, beside the interpreter: it may be in a long call of a library and
// answers no signal then.
#pragma once
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <thread>

namespace swgpar {

constexpr int LONGEST = 6000;  // bytes of a text

// A text that is set by the interpreter and read by a signal handler or another thread: one of two
// buffers is complete.
struct Text {
  char letters[2][LONGEST] = {};
  int length[2] = {0, 0};
  std::atomic<int> current{0};

  void set(const char* from, int count) {
    const int other = 1 - current.load();
    length[other] = count < LONGEST ? count : LONGEST;
    std::memcpy(letters[other], from, length[other]);
    current.store(other);
  }
  void put(int file) const {
    const int now = current.load();
    for (int done = 0; done < length[now];) {
      const ssize_t count = ::write(file, letters[now] + done, length[now] - done);
      if (count <= 0) return;
      done += static_cast<int>(count);
    }
  }
};

inline Text before_name, after_name, sign_of_life;
inline std::atomic<pid_t> owner{0};

// Ends the process: what is on the disk is complete at any moment. Only functions that a signal
// handler may call.
inline void end(int number) {
  if (getpid() == owner.load() && after_name.length[after_name.current.load()] > 0) {
    before_name.put(2);
    const char* name = number == SIGINT ? "SIGINT" : number == SIGTERM ? "SIGTERM" : "SIGHUP";
    ssize_t ignored = ::write(2, name, std::strlen(name));
    (void)ignored;
    after_name.put(2);
  }
  _exit(number == SIGINT ? 130 : 143);
}

inline void arm(int number) {
  struct sigaction action = {};
  action.sa_handler = end;
  sigfillset(&action.sa_mask);
  owner.store(getpid());
  sigaction(number, &action, nullptr);
}

using Clock = std::chrono::steady_clock;

inline double seconds() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

inline std::atomic<double> last_output{0.0};
inline std::atomic<bool> beating{false};
inline std::thread* heart = nullptr;  // never destroyed: a process may end while it beats

inline void note_output() { last_output.store(seconds()); }

// A line on stdout whenever nothing else has been written for so many seconds.
inline void beat(double interval) {
  double quiet_since = last_output.load(), written = quiet_since;
  while (beating.load()) {
    std::this_thread::sleep_for(
        std::chrono::duration<double>(interval < 2.0 ? interval / 20.0 : 0.1));
    const double now = seconds(), last = last_output.load();
    if (last != quiet_since) quiet_since = written = last;
    if (now - written < interval) continue;
    written = now;
    const time_t calendar = ::time(nullptr);
    struct tm local;
    localtime_r(&calendar, &local);
    char line[LONGEST + 100];
    const int text = sign_of_life.current.load();
    const int count =
        std::snprintf(line, sizeof line, "%02d:%02d:%02d  %.*s, no news for %.0f s\n",
                      local.tm_hour, local.tm_min, local.tm_sec, sign_of_life.length[text],
                      sign_of_life.letters[text], now - quiet_since);
    ssize_t ignored = ::write(1, line, count);
    (void)ignored;
  }
}

inline void start_heart(double interval) {
  if (beating.exchange(true)) return;
  note_output();
  heart = new std::thread(beat, interval);
}

inline void stop_heart() {
  if (!beating.exchange(false)) return;
  heart->join();
  delete heart;
}

}  // namespace swgpar
