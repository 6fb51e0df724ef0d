// Lines of contact: compliance that the elements under a flank lack, and the tangent, by which the
// cells of a line couple.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "contact.hpp"

namespace swgpar {

// What the elements under a flank lack in compliance; see swgpar/contact/missing_compliance.py.
struct MissingCompliance {
  int n_node;
  const double* s;      // (n_node) arc lengths
  const double* green;  // (n_node, n_node) displacements of the nodes by forces on them
  double logarithm;     // the half plane's surface yields -logarithm ln|x| under a unit force
};

// Mean of ln|x - x'| over x and x' in two strips of these widths, their middles apart.
inline double mean_log(double apart, double width, double other) {
  const auto twice_integrated = [](double x) {
    const double size = std::abs(x);
    return size < 1e-300 ? 0.0 : 0.5 * x * x * (std::log(size) - 1.5);
  };
  const double plus = 0.5 * (width + other), minus = 0.5 * (width - other);
  return (twice_integrated(apart + plus) - twice_integrated(apart + minus) -
          twice_integrated(apart - minus) + twice_integrated(apart - plus)) /
         (width * other);
}

// Adds the missing compliance (n, n), mm / (N/mm), among strips low .. high (mm), each within a
// facet: means over the strips under unit forces spread over them.
inline void add_missing_compliance(const MissingCompliance& m, int n, const double* low,
                                   const double* high, double* out) {
  std::vector<int> facet(n);
  std::vector<double> middle(n), width(n), place(n);
  for (int j = 0; j < n; ++j) {
    middle[j] = 0.5 * (low[j] + high[j]);
    width[j] = high[j] - low[j];
    const auto after = std::upper_bound(m.s, m.s + m.n_node, middle[j]) - m.s;
    facet[j] = std::clamp(static_cast<int>(after) - 1, 0, m.n_node - 2);
    const double* s = m.s + facet[j];
    place[j] = (middle[j] - s[0]) / (s[1] - s[0]);
  }
  const double first = m.s[0], last = m.s[m.n_node - 1];
  for (int i = 0; i < n; ++i) {
    const double* row = m.green + static_cast<std::int64_t>(facet[i]) * m.n_node;
    for (int j = i; j < n; ++j) {
      double log = mean_log(middle[i] - middle[j], width[i], width[j]);
      for (const double end : {first, last})
        log += mean_log(middle[i] - (2 * end - middle[j]), width[i], width[j]);
      const double *g = row + facet[j], *h = g + m.n_node;
      const double p = place[i], q = place[j];
      const double elements =
          (1 - p) * ((1 - q) * g[0] + q * g[1]) + p * ((1 - q) * h[0] + q * h[1]);
      const double value = -m.logarithm * log - elements;
      out[static_cast<std::int64_t>(i) * n + j] += value;
      if (i != j) out[static_cast<std::int64_t>(j) * n + i] += value;
    }
  }
}

// Adds sum_ij g_i S_ij h_j^T of the cells of one line to the owned rows: g, h are the gradients of
// a cell's gap, n_node (3) vectors, and S the stiffness.
//   node, image : (n_cell, n_node) local nodes, -1 without unknowns, and their sixths of a turn
//   left, right : (n_cell, n_node, 3);  stiffness : (n_cell, n_cell)
// Returns the blocks that the pattern lacks.
inline std::int64_t add_line_tangent(int n_cell, int n_node, const std::int32_t* node,
                                     const std::uint8_t* image, const double* left,
                                     const double* right, const double* stiffness,
                                     const BlockRows& rows) {
  std::vector<std::int64_t> key;
  key.reserve(n_cell * n_node);
  for (int k = 0; k < n_cell * n_node; ++k)
    if (node[k] >= 0) key.push_back(8 * static_cast<std::int64_t>(node[k]) + image[k]);
  std::sort(key.begin(), key.end());
  key.erase(std::unique(key.begin(), key.end()), key.end());
  const int n = static_cast<int>(key.size());
  Eigen::MatrixXd g = Eigen::MatrixXd::Zero(n_cell, 3 * n),
                  h = Eigen::MatrixXd::Zero(n_cell, 3 * n);
  for (int c = 0; c < n_cell; ++c) {
    for (int a = 0; a < n_node; ++a) {
      const int k = c * n_node + a;
      if (node[k] < 0) continue;
      const std::int64_t wanted = 8 * static_cast<std::int64_t>(node[k]) + image[k];
      const auto at = std::lower_bound(key.begin(), key.end(), wanted) - key.begin();
      for (int d = 0; d < 3; ++d) {
        g(c, 3 * at + d) += left[3 * k + d];
        h(c, 3 * at + d) += right[3 * k + d];
      }
    }
  }
  const Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>> s(stiffness, n_cell,
                                                                           n_cell);
  const Eigen::MatrixXd tangent = g.transpose() * (s * h);
  std::int64_t missing = 0;
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < n; ++b) {
      const Mat3 block = tangent.block<3, 3>(3 * a, 3 * b);
      if (!rows.add(static_cast<std::int32_t>(key[a] / 8), static_cast<std::uint8_t>(key[a] % 8),
                    static_cast<std::int32_t>(key[b] / 8), static_cast<std::uint8_t>(key[b] % 8),
                    block))
        ++missing;
    }
  }
  return missing;
}

}  // namespace swgpar
