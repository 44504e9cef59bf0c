# A student of reinforcement learning: an environment, a policy of her own, and how good it is.
flatrig docs OverheadCrane > environment.md
python -c "
import gymnasium
from flatrig import envs
env = gymnasium.make('flatrig/OverheadCrane-v0', disturbances='standard')
print(env.reset(seed=0)[0].shape, env.step(env.action_space.sample())[1])
"
flatrig train overhead --sensors sway --iterations 1 --episodes 4 --threads 1 -o trained
flatrig plot trained -o curves.png
flatrig compare overhead --policy trained/policy.json --scenarios 4 --sets own --json -o compared > compared.json
