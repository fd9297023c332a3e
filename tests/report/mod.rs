/// The figure of a replayed run.
mod replay_figure;
