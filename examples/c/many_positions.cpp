// Positions of a four-bar for many angles of its crank, side by side in threads, each with handles of its own.
#include <mech9.h>

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

using Mechanism = std::unique_ptr<mech9_mechanism, decltype(&mech9_mechanism_destroy)>;
using Positions = std::unique_ptr<mech9_positions, decltype(&mech9_positions_destroy)>;
using Failure = std::unique_ptr<mech9_error, decltype(&mech9_error_destroy)>;

static void check(int code, const Failure &failure)
{
  if (code) throw std::runtime_error(mech9_error_message(failure.get()));
}

static std::vector<double> positions(const char *path, double from, double to, int n)
{
  Failure failure(mech9_error_create(), mech9_error_destroy);
  mech9_mechanism *read = nullptr;
  check(mech9_read_file(path, &read, failure.get()), failure);
  Mechanism mechanism(read, mech9_mechanism_destroy);
  mech9_positions *assembled = nullptr;
  check(mech9_positions_create(mechanism.get(), &assembled, failure.get()), failure);
  Positions all(assembled, mech9_positions_destroy);
  std::vector<double> values(n), q(n*mech9_positions_coordinates(all.get()));
  std::vector<int> codes(n);
  for (int i = 0; i < n; i++) values[i] = from + (to - from)*i/(n - 1);
  check(mech9_positions_find(all.get(), n, values.data(), nullptr, nullptr, nullptr, q.data(), nullptr, nullptr, codes.data(),
                             failure.get()), failure);
  return q;
}

int main(int arguments, char **argument)
{
  const char *path = arguments > 1 ? argument[1] : "four_bar.nml";
  std::vector<std::vector<double>> found(8);
  std::vector<std::thread> threads;
  for (auto &q : found)
    threads.emplace_back([&q, path] {
      try { q = positions(path, 0, 6, 100); } catch (const std::exception &failure) { std::fprintf(stderr, "%s\n", failure.what()); }
    });
  for (auto &thread : threads) thread.join();
  for (auto &q : found)
    if (q.empty() || q != found[0]) return 1;
  std::printf("8 threads found the same 100 positions; the last one has q2 = %.6f\n", found[0][4*99 + 1]);
}
