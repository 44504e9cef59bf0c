# A student of reinforcement learning: an environment, an agent of stable-baselines3 on it, and how
# good the shipped residual is beside classical controllers.
flatrig docs OverheadCrane > environment.md
python -c "
import gymnasium as gym
from stable_baselines3 import PPO
from flatrig import envs
from flatrig.envs.sb3 import VecEnv

vector = gym.make_vec('flatrig/OverheadCrane-v0', num_envs=8, autoreset_mode='SameStep')
vector = envs.Residual(envs.Feedforward(envs.PD(vector)), fraction=0.1)
agent = PPO('MlpPolicy', VecEnv(vector), n_steps=64, device='cpu')
agent.learn(512)
agent.save('agent')
"
flatrig run overhead --controller residual --scenario load_mass=1.2 --json -o run > run.json
flatrig compare overhead --scenarios 2 --sets own --json -o compared > compared.json
