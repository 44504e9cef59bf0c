"""flatrig: describe a crane, a cable manipulator or a rolling-contact hand once, and get from that
one description its MuJoCo model, its exact feedforward (inverse dynamics) and its Gymnasium
environment.  The parts are `flatrig.models`, `flatrig.feedforward`, `flatrig.envs` and
`flatrig.training`; nothing is loaded until it is imported.
"""
