// The linear equations of log albedo, which the albedo step solves and the test of its prior's strength probes.
#pragma once
#include <Eigen/SparseCore>

#include "solve/albedo/albedo_step.h"
#include "solve/albedo/channel_values.h"

namespace relamp {

/// The quadratic model of log albedo about `logAlbedo` (per mesh vertex): matrix x = moment, for all channels at once.
struct AlbedoSystem {
    Eigen::SparseMatrix<ChannelValues> matrix;
    Eigen::Matrix<ChannelValues, Eigen::Dynamic, 1> moment;
    std::vector<ChannelValues> precision;  ///< per observation: what it adds to its vertex's diagonal
    std::vector<float> own;                ///< per mesh vertex: fraction of that in its diagonal, mean of the channels
};
AlbedoSystem albedoSystem(const Scene& scene, const MatteObservations& matte, const std::vector<Rgb>& lit,
                          const std::vector<Rgb>& litSigma, const AlbedoPrior& prior, const std::vector<Rgb>& logAlbedo,
                          double edge, const ChannelValues& typical);

}  // namespace relamp
